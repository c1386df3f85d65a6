!> Simulations for test programs, each made by one call. A local variable of this type would be begun and freed by 60 kB of machine
!> code in every procedure that has one.
module fresh_simulations
  use sg_simulation, only: simulation_t
  implicit none
  private
  public :: fresh, run_t

  !> A simulation in a list, or none.
  type :: run_t
    type(simulation_t), pointer :: sim => null()
  end type run_t

  !> A simulation that was handed out.
  type :: held_t
    type(simulation_t), pointer :: sim => null()
    type(held_t), pointer :: before => null() !! the one handed out before
  end type held_t

  !> Simulations stay until the program ends, within reach, so that a leak checker reports what they lost alone.
  type(held_t), pointer, save :: last => null()

contains

  !> A simulation with nothing in it, or a copy.
  function fresh(from) result(sim)
    type(simulation_t), optional, intent(in) :: from !! what is copied
    type(simulation_t), pointer :: sim !! the new one
    type(held_t), pointer :: held

    allocate (held)
    allocate (held%sim)
    held%before => last
    last => held
    sim => held%sim
    if (present(from)) sim = from
  end function fresh

end module fresh_simulations
