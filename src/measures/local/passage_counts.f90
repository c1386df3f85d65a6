!> Bodies that enter and leave: let in and out between two steps, with the energy that they carry; counted for the record.
module sg_passage_counts
  use sg_bodies, only: body_present, body_removed, body_waiting
  use sg_comm, only: comm_t
  use sg_drives, only: fix_driven, mark_walls
  use sg_energy, only: energy_t
  use sg_kinds, only: wp, i4
  use sg_passages, only: due_time
  use sg_presence, only: let_body_in, let_body_out
  use sg_scene, only: scene_t
  use sg_tally, only: column_t
  implicit none
  private
  public :: let_pass, count_passages, passage_columns, n_passage_sums

  !> Grains that wait; grains that entered and their mass; grains that were removed and their mass
  integer, parameter :: n_passage_sums = 5

contains

  !> Let bodies in and out.
  subroutine let_pass(scene, next, energy)
    type(scene_t), intent(inout) :: scene !! scene between two steps
    integer(i4), intent(in) :: next(:) !! presence of each body from now on, one of `body_*`
    type(energy_t), intent(inout) :: energy !! balance to keep closed
    logical :: is_new
    integer :: b

    is_new = .false.
    do b = 1, scene%bodies%n
      if (next(b) == scene%bodies%presence(b)) cycle
      if (next(b) == body_present) then
        call let_body_in(scene%bodies, b)
        is_new = .true.
        if (b <= scene%bodies%n_own) call energy%let_pass(scene, b, .true.)
      else
        if (b <= scene%bodies%n_own) call energy%let_pass(scene, b, .false.)
        call let_body_out(scene%bodies, b, next(b))
      end if
    end do
    if (.not. is_new) return
    call fix_driven(scene%drives, scene%bodies)
    call mark_walls(scene%drives, scene%pressures, scene%bodies)
  end subroutine let_pass

  !> Columns of the record: numbers of grains that wait, entered and left, and the masses [kg] of the latter two.
  pure function passage_columns(sums) result(columns)
    real(wp), intent(in) :: sums(n_passage_sums) !! of `count_passages`
    type(column_t) :: columns(n_passage_sums)
    character(len=*), parameter :: names(n_passage_sums) = [character(len=12) :: 'waiting', 'entered', 'mass_entered', &
                                                            'removed', 'mass_removed']

    columns%name = names
    columns%value = sums
    columns([1, 2, 4])%is_count = .true.
  end function passage_columns

  !> Sums over the bodies of all ranks. Collective.
  subroutine count_passages(scene, comm, sums)
    type(scene_t), intent(in) :: scene !! scene in which bodies may enter or leave
    type(comm_t), intent(inout) :: comm !! the ranks
    real(wp), intent(out) :: sums(n_passage_sums) !! in the order of the columns

    sums = own_sums(scene)
    if (comm%size > 1) call comm%sum(sums)
  end subroutine count_passages

  !> The sums over this rank's bodies.
  pure function own_sums(scene) result(sums)
    type(scene_t), intent(in) :: scene
    real(wp) :: sums(n_passage_sums)
    integer :: b, number

    sums = 0
    do b = 1, scene%bodies%n_own
      associate (presence => scene%bodies%presence(b), mass => scene%bodies%mass(b))
        if (presence < 0 .or. (presence == body_present .and. .not. scene%bodies%is_grain(b))) cycle
        number = b
        if (allocated(scene%bodies%id)) number = scene%bodies%id(b)
        if (presence == body_waiting) then
          sums(1) = sums(1) + 1
          cycle
        end if
        if (allocated(scene%entries)) then
          if (any(due_time(scene%entries, number) < huge(1.0_wp))) sums(2:3) = sums(2:3) + [1.0_wp, mass]
        end if
        if (presence == body_removed) sums(4:5) = sums(4:5) + [1.0_wp, mass]
      end associate
    end do
  end function own_sums
end module sg_passage_counts
