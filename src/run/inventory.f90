!> Tables that a simulation holds between two steps, part by part.
!!
!! What grows neither with the bodies nor with the contacts is left out, and so is what a step makes and gives back. That nothing
!! else is left out shows where the sum is compared with the memory that the program has in use (tests/cli/test_needs.py).
module sg_inventory
  use sg_contactors, only: contactors_t, table_all, table_vertices
  use sg_history, only: history_t
  use sg_kinds, only: wp, i8
  use sg_neighbour_list, only: neighbours_t
  use sg_polyhedron, only: polyhedron_t
  use sg_problem, only: growth_of_problem, problem_t
  use sg_simulation, only: simulation_t
  use sg_tables, only: per_body, per_contact, tables_t
  implicit none
  private
  public :: expected_memory, list_tables

contains

  !> Memory that a run will take at its largest [bytes], estimated from its first detection: its tables with the contact problem and
  !! the contacts of a step before, its list of neighbours once more while a new one grows, and the program itself.
  real(wp) function expected_memory(sim) result(bytes)
    type(simulation_t), intent(in) :: sim !! its contacts are found, and nothing is assembled
    real(wp), parameter :: program_bytes = 28e6_wp
    type(tables_t) :: tables, pairs

    call list_tables(sim, tables)
    call list_pairs(sim%pairs, pairs)
    bytes = program_bytes + real(tables%bytes_per(per_body) + tables%bytes_per(per_contact) + pairs%bytes_per(per_contact) + &
                                 growth_of_problem(sim%problem, sim%plan%kind, sim%contacts%n), wp)
  end function expected_memory

  !> List the tables of a simulation.
  subroutine list_tables(sim, tables)
    type(simulation_t), intent(in) :: sim !! after a step
    type(tables_t), intent(out) :: tables !! allocated ones and others

    call tables%begin('bodies', per_body)
    call sim%scene%bodies%note(tables)
    call tables%begin('plan', per_body)
    call tables%note('radius', sim%plan%radius)
    call list_contactors(sim%scene%contactors, tables)
    call list_pairs(sim%pairs, tables)
    call tables%begin('contacts', per_contact)
    call sim%contacts%note(tables)
    call list_history(sim%history, tables)
    call list_problem('problem', sim%problem, tables)
    call sim%solver%list_tables(tables)
    if (allocated(sim%pusher)) call sim%pusher%list_tables(tables)
    call tables%begin('solver', per_body)
    call tables%note('carried_body', sim%solver%carried_body)
    call tables%begin('solver', per_contact)
    call tables%note('carried_contact', sim%solver%carried_contact)
    call sim%decomposition%list_tables(tables)
    call sim%carry%list_tables(tables)
    call sim%step_start%list_tables(tables)
    call tables%begin('trace', per_contact)
    call tables%note('guess_impulse', sim%guess_impulse)
    call tables%begin('trace', per_body)
    call tables%note('guess_body', sim%guess_body)
  end subroutine list_tables

  !> Tables of contactors and of their shapes.
  subroutine list_contactors(contactors, tables)
    type(contactors_t), intent(in) :: contactors
    type(tables_t), intent(inout) :: tables
    integer(i8) :: bytes
    integer :: i

    call tables%begin('contactors', per_body)
    do i = table_all, table_vertices
      call contactors%note(tables, i)
    end do
    bytes = -1
    if (allocated(contactors%space%polyhedra)) then
      bytes = 0
      do i = 1, size(contactors%space%polyhedra)
        bytes = bytes + bytes_of(contactors%space%polyhedra(i))
      end do
    end if
    call tables%add('polyhedra', bytes)
  end subroutine list_contactors

  !> Bytes of a polyhedron, with those of its own tables.
  integer(i8) function bytes_of(polyhedron) result(bytes)
    type(polyhedron_t), intent(in) :: polyhedron
    type(tables_t) :: tables

    call tables%note('vertex', polyhedron%vertex)
    call tables%note('face_first', polyhedron%face_first)
    call tables%note('face_vertex', polyhedron%face_vertex)
    call tables%note('normal', polyhedron%normal)
    call tables%note('edge', polyhedron%edge)
    call tables%note('world_vertex', polyhedron%world_vertex)
    call tables%note('world_normal', polyhedron%world_normal)
    call tables%note('face_height', polyhedron%face_height)
    bytes = tables%bytes_per(per_body) + storage_size(polyhedron)/8
  end function bytes_of

  !> Tables of the list of neighbours: those of pairs count as contacts'.
  subroutine list_pairs(pairs, tables)
    type(neighbours_t), intent(in) :: pairs
    type(tables_t), intent(inout) :: tables

    call tables%begin('neighbours', per_body)
    call tables%note('body_of', pairs%body_of)
    call tables%note('slot_of', pairs%slot_of)
    call tables%note('built', pairs%built)
    call tables%note('margin', pairs%margin)
    call tables%note('motion', pairs%motion)
    call tables%begin('pairs', per_contact)
    call tables%note('contactor', pairs%contactor)
    call tables%note('image', pairs%image)
    call tables%note('image_y', pairs%image_y)
    call tables%note('image_z', pairs%image_z)
    call tables%note('see', pairs%see)
  end subroutine list_pairs

  !> Tables of the contacts of the last step.
  subroutine list_history(history, tables)
    type(history_t), intent(in) :: history
    type(tables_t), intent(inout) :: tables
    integer :: i

    call tables%begin('history', per_contact)
    call tables%note('contactor', history%contactor)
    call tables%note('image', history%image)
    call tables%note('first', history%first)
    call tables%note('feature', history%feature)
    call tables%note('impulse', history%impulse)
    call tables%note('point', history%point)
    call tables%note('status', history%status)
    call tables%note('internal', history%internal)
    call tables%note('carried', history%carried)
    call tables%note('is_kept', history%is_kept)
    call tables%note('kept', history%kept)
    call tables%note('past', history%past)
    call tables%note('face', history%face)
    call tables%note('clearance', history%clearance)
    if (.not. allocated(history%found)) return
    do i = 1, size(history%found)
      call history%found(i)%note(tables)
    end do
  end subroutine list_history

  !> Tables of the contact problem.
  subroutine list_problem(name, problem, tables)
    character(len=*), intent(in) :: name
    type(problem_t), intent(in) :: problem
    type(tables_t), intent(inout) :: tables

    call tables%begin(name, per_contact)
    call tables%note('pair', problem%pair)
    call tables%note('record', problem%record)
    call tables%note('impulse', problem%impulse)
    call tables%note('opening', problem%opening)
    call tables%begin(name, per_body)
    call tables%note('body', problem%body)
    call tables%note('moves', problem%moves)
  end subroutine list_problem
end module sg_inventory
