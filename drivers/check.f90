!> `splitgrain check`: plan and expected memory of a run, and all mistakes of its deck, without the run.
module sg_check
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_deck, only: read_deck
  use sg_error, only: diagnostics_t, error_t, exit_bad_input, exit_done
  use sg_inventory, only: expected_memory
  use sg_memory, only: gigabytes
  use sg_plan, only: describe_plan
  use sg_print, only: print_line
  use sg_simulation, only: simulation_t
  use sg_start_split, only: find_contacts
  use sg_text, only: counted, text_t, to_text
  implicit none
  private
  public :: check_command

contains

  !> Check a deck and print what it holds.
  subroutine check_command(file, settings, code)
    character(len=*), intent(in) :: file !! deck
    type(text_t), intent(in) :: settings(:) !! settings laid over it
    integer, intent(out) :: code !! exit code
    type(simulation_t) :: sim
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error

    call read_deck(file, settings, sim%scene, sim%options, diagnostics)
    call diagnostics%print(error_unit)
    code = exit_bad_input
    if (diagnostics%count() > 0) return
    call find_contacts(sim, error)
    if (allocated(error)) then
      error%file = file
      write (error_unit, '(a)') error%report()
      code = error%code
      return
    end if
    code = exit_done
    call print_counts(file, sim)
    call print_line(describe_plan(sim%plan, sim%scene, ranks=1))
  end subroutine check_command

  !> Print what is not in the plan: time, laws, drives, memory.
  subroutine print_counts(file, sim)
    character(len=*), intent(in) :: file
    type(simulation_t), intent(in) :: sim

    associate (scene => sim%scene, options => sim%options)
      call print_line(file//': no mistakes')
      if (options%title /= '') call print_line('title      '//options%title)
      call print_line('deck       '//options%deck_hash)
      call print_line('time       '//to_text(options%steps)//' steps of '//to_text(options%time_step, 4)//' s')
      call print_line('rules      '//counted(size(scene%laws), 'contact law')//', '// &
        counted(size(scene%sees), 'interaction rule'))
      call print_line('imposed    '//counted(size(scene%drives), 'component')//', '//counted(size(scene%pressures), 'pressure'))
      call print_line('memory     about '//gigabytes(expected_memory(sim))//', with '// &
        counted(sim%contacts%n, 'contact')//' and '//counted(sim%pairs%n, 'pair')//' of neighbours at the start')
    end associate
  end subroutine print_counts
end module sg_check
