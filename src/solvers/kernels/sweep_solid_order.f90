!> Solid contacts with friction dealt to the lanes of vector registers: each lane holds a pair of bodies with all its points.
!!
!! The contacts of a block are cut into *chains*, runs of up to four contacts of one pair. A group is up to `lanes` chains in
!! which no movable body appears twice; its rows are their first, second, ... contacts (doc/theory/nlgs.md).
module sg_sweep_solid_order
  use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t
  use sg_kinds, only: wp, i4, i8
  use sg_lists, only: reserve
  use sg_problem, only: problem_t
  use sg_records, only: first_inverse, least_active, least_linear, normal_x, normal_z, record_length, solid_arm_az, solid_bias_x, &
                        solid_bias_y, solid_bias_z, solid_cohesion, solid_compliance_n, solid_compliance_t, solid_friction, &
                        solid_frictional, solid_law, solid_s1, solid_tangent_x, solid_tangent_z, solid_wn1, solid_wn2, solid_wnn
  use sg_vectors, only: cross
  implicit none
  private
  public :: solid_lanes_t, begin_rows, deal_chains, fill_rows, give_rows, put_row_biases, put_rows, reserve_rows, lanes, &
            row_length
  public :: impulses_of_row, special_length
  public :: row_impulse_n, row_impulse_1, row_impulse_2, row_normal_x, row_normal_y, row_normal_z, row_tangent_x, row_tangent_y
  public :: row_tangent_z, row_arm_cx, row_arm_cy, row_arm_cz, row_arm_ax, row_arm_ay, row_arm_az, row_bias, row_inverse_wnn
  public :: row_g1, row_g2, row_s1, row_s2, row_friction, special_bias_1, special_bias_2, special_compliance_n, special_compliance_t

  !> Contacts side by side
  integer, parameter :: lanes = 8
  !> Places of a contact in a row: impulse on n, t and n x t (cohesion added to the first), directions and arms as in the record
  integer, parameter :: row_impulse_n = 1, row_impulse_1 = 2, row_impulse_2 = 3, row_normal_x = 4, row_normal_y = 5, &
                        row_normal_z = 6, row_tangent_x = 7, row_tangent_y = 8, row_tangent_z = 9, row_arm_cx = 10, &
                        row_arm_cy = 11, row_arm_cz = 12, row_arm_ax = 13, row_arm_ay = 14, row_arm_az = 15
  !> The same: bias on n, 1/W_nn, W_n1/W_nn, W_n2/W_nn, S_1, S_2, friction or -1 for a linear law. Lanes to spare have no direction
  !! and S = 1
  integer, parameter :: row_bias = 16, row_inverse_wnn = 17, row_g1 = 18, row_g2 = 19, row_s1 = 20, row_s2 = 21, row_friction = 22
  !> Places of a contact with an uncommon law: bias on t and n x t, compliance
  integer, parameter :: special_bias_1 = 1, special_bias_2 = 2, special_compliance_n = 3, special_compliance_t = 4
  !> Reals of a contact in a row, and of one with an uncommon law
  integer, parameter :: row_length = row_friction, special_length = special_compliance_t
  !> Reals of the impulses of a row, which come first
  integer, parameter :: impulses_of_row = lanes*row_impulse_2

  !> Contacts side by side in the order of the sweep
  type :: solid_lanes_t
    !> Number of groups and of rows
    integer :: n_groups = 0, n_rows = 0
    !> Do all contacts take part, without cohesion? Then their impulses follow from the rows alone
    logical :: are_plain = .false.
    !> Last row of each group, and contacts of each row
    integer(i4), allocatable :: last_row(:), row_size(:)
    !> Slots of candidate and antagonist, shape (lanes, 2, groups)
    integer(i4), allocatable :: pair(:, :, :)
    !> Impulses and records, shape (lanes, row_length, rows)
    real(wp), allocatable :: row(:, :, :)
    !> Shape (lanes, special_length, rows), or no rows where all laws are ordinary
    real(wp), allocatable :: special(:, :, :)
  end type solid_lanes_t

  interface
    !> Put up to eight contacts side by side (solid_rows_lanes.cpp).
    pure subroutine put_row(left, n, contact, record, impulse, row, flags) bind(c, name='sg_put_solid_row')
      import :: c_double, c_int
      integer(c_int), intent(in), value :: left !! contacts that are left in the list
      integer(c_int), intent(in), value :: n !! contacts of the row
      integer(c_int), intent(in) :: contact(*) !! which ones
      real(c_double), intent(in) :: record(*), impulse(*)
      real(c_double), intent(inout) :: row(*) !! the row, shape (lanes, row_length)
      integer(c_int), intent(inout) :: flags !! bit 0 is set by a law out of the ordinary, bit 1 by cohesion, or no part taken
    end subroutine put_row

    !> Deal the first block of contacts to rows of new groups (group_dealing.cpp).
    pure subroutine deal_block(n, chosen, length, inverse, pair, body, groups_of, contact, n_groups, n_rows, last_row, row_size, &
                               done) bind(c, name='sg_deal_chains')
      import :: c_double, c_int, c_int64_t
      integer(c_int), intent(in), value :: n !! contacts that are left
      integer(c_int), intent(in) :: chosen(*) !! which ones
      integer(c_int), intent(in), value :: length !! reals of a body
      integer(c_int), intent(in), value :: inverse !! place of its first inverse mass
      integer(c_int), intent(in) :: pair(*) !! slots of all contacts
      real(c_double), intent(in) :: body(*) !! records of bodies
      integer(c_int64_t), intent(inout) :: groups_of(*) !! room, by slot; zero before and after
      integer(c_int), intent(inout) :: contact(*) !! contacts of the block, row by row
      integer(c_int), intent(inout) :: n_groups, n_rows !! groups and rows, which grow
      integer(c_int), intent(inout) :: last_row(*), row_size(*) !! last row of each group, and contacts of each row
      integer(c_int), intent(inout) :: done !! contacts dealt, which grow by those of the block
    end subroutine deal_block
  end interface

contains

  !> Begin with no row, and room for those of so many contacts.
  pure subroutine begin_rows(rows, contacts)
    type(solid_lanes_t), intent(inout) :: rows !! rows to empty
    integer, intent(in) :: contacts !! to be dealt, at most

    if (allocated(rows%last_row)) then
      if (size(rows%last_row) < contacts) deallocate (rows%last_row, rows%row_size)
    end if
    if (.not. allocated(rows%last_row)) allocate (rows%last_row(contacts), rows%row_size(contacts))
    rows%n_groups = 0
    rows%n_rows = 0
  end subroutine begin_rows

  !> Room for rows of more contacts, beside those dealt.
  subroutine reserve_rows(rows, contacts)
    type(solid_lanes_t), intent(inout) :: rows !! begun rows
    integer, intent(in) :: contacts !! to be dealt, at most, with those that are

    call reserve(rows%last_row, contacts)
    call reserve(rows%row_size, contacts)
  end subroutine reserve_rows

  !> Deal chosen contacts to rows of new groups, after those that are there.
  pure subroutine deal_chains(chosen, problem, groups_of, contact, rows)
    integer(i4), intent(in), contiguous :: chosen(:) !! contacts to deal, in spatial order
    type(problem_t), intent(in) :: problem !! problem to sweep
    integer(i8), intent(inout), contiguous :: groups_of(:) !! room, by slot; zero before and after
    integer(i4), intent(inout), contiguous :: contact(:) !! the same contacts, row by row
    type(solid_lanes_t), intent(inout) :: rows !! begun rows, which grow; impulses and records come later
    integer :: done

    done = 0
    do while (done < size(chosen))
      call deal_block(size(chosen) - done, chosen(done + 1:), size(problem%body, 1), first_inverse(solid_frictional), &
                      problem%pair, problem%body, groups_of, contact(done + 1:), rows%n_groups, rows%n_rows, rows%last_row, &
                      rows%row_size, done)
    end do
  end subroutine deal_chains

  !> Put slots, impulses and records side by side, from a first group on. Those before it stay, which takes room behind them.
  subroutine fill_rows(problem, contact, rows, first_group, is_done)
    type(problem_t), intent(in) :: problem !! problem to sweep
    integer(i4), intent(in), contiguous :: contact(:) !! its contacts in the order of the rows
    type(solid_lanes_t), intent(inout) :: rows !! dealt rows to fill
    integer, intent(in) :: first_group !! first one to fill
    logical, intent(out) :: is_done !! not where a law beside rows that stay has no place; always from the first group on
    logical :: is_special, is_found
    integer :: first, e

    first = 1
    if (first_group > 1) first = rows%last_row(first_group - 1) + 1
    e = sum(rows%row_size(:first - 1))
    ! Rates of a cell that change turn biases away from normals.
    is_special = problem%cell%is_on
    is_done = .true.
    if (first_group == 1) then
      call make_room(rows, is_special)
    else
      is_special = is_special .or. any_special(problem, contact(e + 1:))
      is_done = size(rows%special, 3) > 0 .or. .not. is_special
      is_special = size(rows%special, 3) > 0
      call reserve(rows%row, rows%n_rows)
      call reserve(rows%pair, rows%n_groups)
      if (is_special) call reserve(rows%special, rows%n_rows)
    end if
    if (.not. is_done) return
    call put_side_by_side(problem, contact, rows, first_group, first, e, is_special, is_found)
    if (.not. is_found .or. is_special) return
    call make_room(rows, .true.)
    call put_side_by_side(problem, contact, rows, first_group, first, e, .true., is_found)
  end subroutine fill_rows

  !> The same in room that is there, from a first group, its first row and the contact before that on.
  pure subroutine put_side_by_side(problem, contact, rows, first_group, first_row, before, with_special, is_special)
    type(problem_t), intent(in) :: problem
    integer(i4), intent(in), contiguous :: contact(:)
    type(solid_lanes_t), intent(inout) :: rows
    integer, intent(in) :: first_group, first_row, before
    logical, intent(in) :: with_special !! is there room for laws out of the ordinary?
    logical, intent(out) :: is_special !! is there such a law?
    integer :: g, row, i, k, e, first
    integer(c_int) :: flags

    flags = 0
    first = first_row
    e = before
    do g = first_group, rows%n_groups
      do i = 1, lanes
        k = contact(e + merge(i, 1, i <= rows%row_size(first)))
        rows%pair(i, 1, g) = problem%pair(1, k)
        rows%pair(i, 2, g) = problem%pair(2, k)
      end do
      do row = first, rows%last_row(g)
        call put_row(int(size(contact) - e, c_int), rows%row_size(row), contact(e + 1:), problem%record, problem%impulse, &
                     rows%row(1, 1, row), flags)
        do i = 1, merge(lanes, 0, with_special)
          rows%special(i, :, row) = 0
          if (i <= rows%row_size(row)) rows%special(i, :, row) = special_of(problem%record(:, contact(e + i)))
        end do
        e = e + rows%row_size(row)
      end do
      first = rows%last_row(g) + 1
    end do
    is_special = btest(flags, 0)
    rows%are_plain = (rows%are_plain .or. first_group == 1) .and. .not. btest(flags, 1)
  end subroutine put_side_by_side

  !> Has a contact a law out of the ordinary?
  pure logical function any_special(problem, contact)
    type(problem_t), intent(in) :: problem
    integer(i4), intent(in), contiguous :: contact(:)
    integer :: i

    any_special = .false.
    do i = 1, size(contact)
      associate (record => problem%record(:, contact(i)))
        any_special = max(abs(record(solid_compliance_n)), abs(record(solid_compliance_t))) > 0 &
                      .or. is_oblique(record(normal_x:normal_z), record(solid_bias_x:solid_bias_z))
      end associate
      if (any_special) return
    end do
  end function any_special

  !> Room for the rows.
  pure subroutine make_room(rows, is_special)
    type(solid_lanes_t), intent(inout) :: rows
    logical, intent(in) :: is_special !! is there a law out of the ordinary?
    integer :: n_rows, n_groups
    logical :: fits

    fits = allocated(rows%row)
    if (fits) fits = size(rows%row, 3) >= rows%n_rows .and. size(rows%pair, 3) >= rows%n_groups &
                     .and. (size(rows%special, 3) > 0 .eqv. is_special)
    if (fits) return
    if (allocated(rows%row)) deallocate (rows%row, rows%pair, rows%special)
    n_rows = rows%n_rows + rows%n_rows/8
    n_groups = rows%n_groups + rows%n_groups/8
    allocate (rows%row(lanes, row_length, n_rows), rows%pair(lanes, 2, n_groups), &
              rows%special(lanes, special_length, merge(n_rows, 0, is_special)))
  end subroutine make_room

  !> Does the bias of a contact have a part along its tangents?
  pure logical function is_oblique(n, bias)
    real(wp), intent(in) :: n(3), bias(3)
    real(wp) :: most

    ! The product of normal and bias, written out: a call for each contact would take longer than all the rest.
    most = max(abs(n(2)*bias(3) - n(3)*bias(2)), abs(n(3)*bias(1) - n(1)*bias(3)), abs(n(1)*bias(2) - n(2)*bias(1)))
    is_oblique = most > 8*epsilon(1.0_wp)*max(abs(bias(1)), abs(bias(2)), abs(bias(3)))
  end function is_oblique

  !> Copy impulses from the problem to the lanes.
  pure subroutine put_rows(problem, contact, rows)
    type(problem_t), intent(in) :: problem !! problem being swept
    integer(i4), intent(in), contiguous :: contact(:) !! contacts in the order of the rows
    type(solid_lanes_t), intent(inout) :: rows !! filled rows, whose impulses are set
    integer :: row, i, e

    e = 0
    do row = 1, rows%n_rows
      do i = 1, rows%row_size(row)
        e = e + 1
        associate (record => problem%record(:, contact(e)))
          if (record(solid_law) >= 0.5_wp) call put_lane(record, problem%impulse(:, contact(e)), i, rows%row(:, :, row))
        end associate
      end do
    end do
  end subroutine put_rows

  !> Copy the biases of contacts whose records have changed to the lanes, by their axes.
  pure subroutine put_row_biases(problem, contact, rows)
    type(problem_t), intent(in) :: problem !! problem being swept, with rates of a cell
    integer(i4), intent(in), contiguous :: contact(:) !! contacts in the order of the rows
    type(solid_lanes_t), intent(inout) :: rows !! filled rows, whose biases are set
    real(wp) :: n(3), t(3)
    integer :: row, i, e

    e = 0
    do row = 1, rows%n_rows
      do i = 1, rows%row_size(row)
        e = e + 1
        associate (record => problem%record(:, contact(e)), bias => problem%record(solid_bias_x:solid_bias_z, contact(e)))
          if (record(solid_law) < least_active) cycle
          n = rows%row(i, row_normal_x:row_normal_z, row)
          t = rows%row(i, row_tangent_x:row_tangent_z, row)
          rows%row(i, row_bias, row) = dot_product(n, bias) - record(solid_compliance_n)*record(solid_cohesion)
          rows%special(i, special_bias_1:special_bias_2, row) = [dot_product(t, bias), dot_product(cross(n, t), bias)]
        end associate
      end do
    end do
  end subroutine put_row_biases

  !> Write a contact's impulse, by the axes of its lane.
  pure subroutine put_lane(record, impulse, i, row)
    real(wp), intent(in) :: record(record_length(solid_frictional)), impulse(3)
    integer, intent(in) :: i
    real(wp), intent(inout) :: row(lanes, row_length)

    associate (n => row(i, row_normal_x:row_normal_z), t => row(i, row_tangent_x:row_tangent_z))
      row(i, row_impulse_n) = n(1)*impulse(1) + n(2)*impulse(2) + n(3)*impulse(3) + record(solid_cohesion)
      row(i, row_impulse_1) = t(1)*impulse(1) + t(2)*impulse(2) + t(3)*impulse(3)
      row(i, row_impulse_2) = (n(2)*t(3) - n(3)*t(2))*impulse(1) + (n(3)*t(1) - n(1)*t(3))*impulse(2) &
                              + (n(1)*t(2) - n(2)*t(1))*impulse(3)
    end associate
  end subroutine put_lane

  !> Bias on the tangents, and compliance.
  pure function special_of(record) result(special)
    real(wp), intent(in) :: record(:)
    real(wp) :: special(special_length)

    special = [dot_product(record(solid_tangent_x:solid_tangent_z), record(solid_bias_x:solid_bias_z)), &
               dot_product(cross(record(normal_x:normal_z), record(solid_tangent_x:solid_tangent_z)), &
               record(solid_bias_x:solid_bias_z)), record(solid_compliance_n), record(solid_compliance_t)]
  end function special_of

  !> Give the problem the impulses of rows, as vectors in the world's axes [N s].
  pure subroutine give_rows(rows, contact, problem)
    type(solid_lanes_t), intent(in) :: rows !! swept rows
    integer(i4), intent(in), contiguous :: contact(:) !! contacts in the order of the rows
    type(problem_t), intent(inout) :: problem !! its impulses are set, of contacts that take part
    integer :: row, i, e

    e = 0
    do row = 1, rows%n_rows
      if (rows%are_plain) then
        call give_row(rows%row_size(row), contact(e + 1:), rows%row(1, 1, row), problem%impulse)
        e = e + rows%row_size(row)
        cycle
      end if
      do i = 1, rows%row_size(row)
        e = e + 1
        call give_lane(problem%record(:, contact(e)), i, rows%row(:, :, row), problem%impulse(:, contact(e)))
      end do
    end do
  end subroutine give_rows

  !> Impulses of a row of contacts that take part, without cohesion.
  pure subroutine give_row(n, contact, row, impulse)
    integer, intent(in) :: n
    integer(i4), intent(in) :: contact(n)
    real(wp), intent(in) :: row(lanes, row_length)
    real(wp), intent(inout) :: impulse(3, *)
    real(wp) :: own(lanes, 3)
    integer :: i

    do i = 1, lanes
      own(i, 1) = row(i, row_impulse_n)*row(i, row_normal_x) + row(i, row_impulse_1)*row(i, row_tangent_x) &
                  + row(i, row_impulse_2)*(row(i, row_normal_y)*row(i, row_tangent_z) - row(i, row_normal_z)*row(i, row_tangent_y))
      own(i, 2) = row(i, row_impulse_n)*row(i, row_normal_y) + row(i, row_impulse_1)*row(i, row_tangent_y) &
                  + row(i, row_impulse_2)*(row(i, row_normal_z)*row(i, row_tangent_x) - row(i, row_normal_x)*row(i, row_tangent_z))
      own(i, 3) = row(i, row_impulse_n)*row(i, row_normal_z) + row(i, row_impulse_1)*row(i, row_tangent_z) &
                  + row(i, row_impulse_2)*(row(i, row_normal_x)*row(i, row_tangent_y) - row(i, row_normal_y)*row(i, row_tangent_x))
    end do
    do i = 1, n
      impulse(1, contact(i)) = own(i, 1)
      impulse(2, contact(i)) = own(i, 2)
      impulse(3, contact(i)) = own(i, 3)
    end do
  end subroutine give_row

  !> Impulse of a lane, by the axes of the lane: those of the record may have been others when it was filled (divided masses).
  pure subroutine give_lane(record, i, row, impulse)
    real(wp), intent(in) :: record(record_length(solid_frictional)), row(lanes, row_length)
    integer, intent(in) :: i
    real(wp), intent(inout) :: impulse(3)
    real(wp) :: n(3), t(3), normal

    if (record(solid_law) < least_active) return
    normal = row(i, row_impulse_n) - record(solid_cohesion)
    n = row(i, row_normal_x:row_normal_z)
    t = row(i, row_tangent_x:row_tangent_z)
    impulse(1) = normal*n(1) + row(i, row_impulse_1)*t(1) + row(i, row_impulse_2)*(n(2)*t(3) - n(3)*t(2))
    impulse(2) = normal*n(2) + row(i, row_impulse_1)*t(2) + row(i, row_impulse_2)*(n(3)*t(1) - n(1)*t(3))
    impulse(3) = normal*n(3) + row(i, row_impulse_1)*t(3) + row(i, row_impulse_2)*(n(1)*t(2) - n(2)*t(1))
  end subroutine give_lane
end module sg_sweep_solid_order
