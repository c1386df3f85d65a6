!> The contact problem of a step, kept in compact records, as matrices: for files, and for solvers that factorise.
!!
!! Unknown velocities are those of the bodies that contacts push, where they are not driven; what driven ones do is in the
!! offset w, as are biases. They are taken so that M is diagonal: spins in space are about the principal axes, and where
!! records hold R spin in place of the spin, its mass is I/R^2. Cohesion c moves the impulses, r' = r + (c, 0), so that the
!! cone has its tip at zero. Compliance is added to W, which then has no global form. In problems without tangents those of
!! the matrices are made up: friction is zero, and so is q along them.
module sg_problem_matrices
  use sg_condense, only: condense, set_local_form, sparse_from_blocks
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4
  use sg_matrix_problem, only: matrix_problem_t
  use sg_problem, only: problem_t
  use sg_problem_records, only: body_record_t, body_of, contact_of, contact_record_t
  use sg_records, only: is_in_space
  use sg_sparse, only: multiply, sparse_from_triplets
  use sg_sparse_algebra, only: diagonal_matrix, sum_of
  use sg_text, only: to_text
  implicit none
  private
  public :: matrices_map_t, matrices_of
  ! Parts of it, for problems that several ranks hold
  public :: take_contacts, find_pushed, mapping_entries, finish_velocities

  !> Where the rows of the matrices come from
  type :: matrices_map_t
    !> Contact of the problem for each contact of the matrices: those that can carry no impulse are left out
    integer(i4), allocatable :: contact(:)
    !> Cohesion of each contact of the matrices [N s]
    real(wp), allocatable :: cohesion(:)
    !> Slot of the body, and component of its velocity, of each unknown velocity
    integer(i4), allocatable :: slot(:), component(:)
  end type matrices_map_t

contains

  !> Make the matrices of a problem; `r` holds its impulses.
  subroutine matrices_of(problem, is_solved, matrices, map, error)
    type(problem_t), intent(in) :: problem !! problem of a step
    logical, intent(in) :: is_solved !! do the bodies move as the impulses make them? If not, as without any
    type(matrix_problem_t), intent(out) :: matrices !! the same problem
    type(matrices_map_t), intent(out) :: map !! where its rows come from
    type(error_t), allocatable, intent(out) :: error !! set when a law cannot be expressed so
    type(contact_record_t), allocatable :: contacts(:)
    type(body_record_t), allocatable :: bodies(:)
    real(wp), allocatable :: pushed(:), impulse(:, :)
    integer :: k

    matrices%d = merge(3, 2, is_in_space(problem%kind))
    call take_contacts(problem, map, contacts, error)
    if (allocated(error)) return
    matrices%n = size(contacts)
    allocate (matrices%friction(matrices%n), matrices%r(matrices%d, matrices%n), impulse(matrices%d, matrices%n))
    do k = 1, matrices%n
      matrices%friction(k) = contacts(k)%friction
      impulse(:, k) = contacts(k)%impulse(:matrices%d)
    end do
    call set_masses(problem, map, matrices, bodies)
    call set_mapping(problem, contacts, map, bodies, matrices)
    allocate (pushed(size(matrices%f)))
    matrices%r = impulse
    matrices%r(1, :) = matrices%r(1, :) + map%cohesion
    ! f = M v without impulses; those of cohesion, which r' has too much, are taken away too.
    if (.not. is_solved) impulse = 0
    impulse(1, :) = impulse(1, :) + map%cohesion
    call multiply(matrices%h, reshape(impulse, [size(impulse)]), pushed)
    matrices%f = matrices%f - pushed
    matrices%has_global = .true.
    call condense(matrices, error)
    if (.not. allocated(error)) call finish_laws(contacts, matrices)
  end subroutine matrices_of

  !> Take all contacts that can carry an impulse from their records.
  subroutine take_contacts(problem, map, contacts, error)
    type(problem_t), intent(in) :: problem !! problem of a step
    type(matrices_map_t), intent(inout) :: map !! its contacts and their cohesion are set
    type(contact_record_t), allocatable, intent(out) :: contacts(:) !! those contacts
    type(error_t), allocatable, intent(out) :: error !! set when a law cannot be expressed so
    type(contact_record_t) :: contact
    integer :: k, n

    allocate (contacts(problem%n_contacts), map%contact(problem%n_contacts))
    n = 0
    do k = 1, problem%n_contacts
      contact = contact_of(problem, k)
      if (.not. contact%is_active) cycle
      if (contact%is_linear) then
        call fail(error, 'contact '//to_text(k)//' has a linear law, which is no cone: there is no such problem in matrices')
        return
      end if
      if (contact%has_moment) then
        call fail(error, 'contact '//to_text(k)//' bears a moment that resists rolling: matrices of contact problems have no '// &
                  'place for it')
        return
      end if
      if (contact%is_bonded) then
        call fail(error, 'contact '//to_text(k)//' is held by a cohesive zone: matrices of contact problems have no place for it')
        return
      end if
      n = n + 1
      contacts(n) = contact
      map%contact(n) = int(k, i4)
    end do
    contacts = contacts(:n)
    map%contact = map%contact(:n)
    allocate (map%cohesion(n))
    map%cohesion = contacts%cohesion
  end subroutine take_contacts

  !> Which bodies contacts of the matrices push, by slot.
  pure function find_pushed(problem, map) result(is_pushed)
    type(problem_t), intent(in) :: problem !! problem of a step
    type(matrices_map_t), intent(in) :: map !! its contacts are set
    logical :: is_pushed(problem%n_bodies)
    integer :: n

    is_pushed = .false.
    do n = 1, size(map%contact)
      is_pushed(problem%pair(:, map%contact(n))) = .true.
    end do
  end function find_pushed

  !> Number the unknown velocities, and set M and f = M v.
  subroutine set_masses(problem, map, matrices, bodies)
    type(problem_t), intent(in) :: problem
    type(matrices_map_t), intent(inout) :: map
    type(matrix_problem_t), intent(inout) :: matrices
    type(body_record_t), allocatable, intent(out) :: bodies(:) !! by slot; of those that are pushed
    logical, allocatable :: is_pushed(:)
    real(wp), allocatable :: mass(:)
    integer :: s, i, n

    allocate (is_pushed, source=find_pushed(problem, map))
    allocate (bodies(problem%n_bodies))
    n = 6*count(is_pushed)
    allocate (map%slot(n), map%component(n), mass(n), matrices%f(n))
    n = 0
    do s = 1, problem%n_bodies
      if (.not. is_pushed(s)) cycle
      bodies(s) = body_of(problem, s)
      do i = 1, bodies(s)%n
        if (.not. bodies(s)%inverse_mass(i) > 0) cycle
        n = n + 1
        map%slot(n) = int(s, i4)
        map%component(n) = int(i, i4)
        mass(n) = 1/bodies(s)%inverse_mass(i)
        matrices%f(n) = mass(n)*bodies(s)%velocity(i)
      end do
    end do
    map%slot = map%slot(:n)
    map%component = map%component(:n)
    matrices%f = matrices%f(:n)
    matrices%mass = diagonal_matrix(mass(:n))
  end subroutine set_masses

  !> Set H, and the offset w of biases and driven velocities.
  subroutine set_mapping(problem, contacts, map, bodies, matrices)
    type(problem_t), intent(in) :: problem
    type(contact_record_t), intent(in) :: contacts(:)
    type(matrices_map_t), intent(in) :: map
    type(body_record_t), intent(in) :: bodies(:)
    type(matrix_problem_t), intent(inout) :: matrices
    integer(i4), allocatable :: unknown(:, :), row(:), column(:)
    real(wp), allocatable :: value(:)
    integer :: i

    allocate (unknown(6, problem%n_bodies), source=0_i4)
    do i = 1, size(map%slot)
      unknown(map%component(i), map%slot(i)) = int(i, i4)
    end do
    call mapping_entries(problem, contacts, map%contact, bodies, unknown, row, column, value, matrices%offset)
    call sparse_from_triplets(size(matrices%f), matrices%d*size(contacts), row, column, value, matrices%h)
  end subroutine set_mapping

  !> Entries of H, and the offset w of biases and driven velocities.
  subroutine mapping_entries(problem, contacts, contact, bodies, unknown, row, column, value, offset)
    type(problem_t), intent(in) :: problem !! problem of a step
    type(contact_record_t), intent(in) :: contacts(:) !! contacts of the matrices
    integer(i4), intent(in) :: contact(:) !! number of each in the problem
    type(body_record_t), intent(in) :: bodies(:) !! by slot
    integer(i4), intent(in) :: unknown(:, :) !! number of each unknown velocity, 0 for driven ones, shape (6, slots)
    integer(i4), allocatable, intent(out) :: row(:) !! unknown of each entry
    integer(i4), allocatable, intent(out) :: column(:) !! component of a contact of each entry
    real(wp), allocatable, intent(out) :: value(:) !! its value
    real(wp), allocatable, intent(out) :: offset(:) !! w [m/s], shape (d n)
    real(wp) :: h(3, 6)
    integer :: k, i, c, side, e, place, d

    d = merge(3, 2, is_in_space(problem%kind))
    allocate (row(12*d*size(contacts)), column(12*d*size(contacts)), value(12*d*size(contacts)))
    allocate (offset(d*size(contacts)))
    e = 0
    do k = 1, size(contacts)
      offset(d*(k - 1) + 1:d*k) = contacts(k)%bias(:d)
      do side = 1, 2
        associate (slot => problem%pair(side, contact(k)))
          h = contacts(k)%h(:, :, side)
          if (is_in_space(problem%kind)) h(:, 4:6) = matmul(h(:, 4:6), bodies(slot)%axes)
          do c = 1, bodies(slot)%n
            do i = 1, d
              place = d*(k - 1) + i
              if (unknown(c, slot) == 0) then
                offset(place) = offset(place) + h(i, c)*bodies(slot)%velocity(c)
              else if (abs(h(i, c)) > 0) then
                e = e + 1
                row(e) = unknown(c, slot)
                column(e) = int(place, i4)
                value(e) = h(i, c)
              end if
            end do
          end do
        end associate
      end do
    end do
    row = row(:e)
    column = column(:e)
    value = value(:e)
  end subroutine mapping_entries

  !> What laws change once W and q are there: compliance, and tangents that are made up.
  subroutine finish_laws(contacts, matrices)
    type(contact_record_t), intent(in) :: contacts(:)
    type(matrix_problem_t), intent(inout) :: matrices
    real(wp) :: compliance(matrices%d, size(contacts)), q(matrices%d*size(contacts))

    call finish_velocities(contacts, matrices%q, matrices%offset, compliance)
    if (.not. any(compliance > 0)) return
    matrices%has_global = .false.
    q = reshape(matrices%q, [size(q)])
    call set_local_form(matrices, sum_of(sparse_from_blocks(matrices%w), 1.0_wp, &
                                         diagonal_matrix(reshape(compliance, [size(q)]))), q)
  end subroutine finish_laws

  !> What laws change in q and in the offset w; and the compliance that W takes.
  pure subroutine finish_velocities(contacts, q, offset, compliance)
    type(contact_record_t), intent(in) :: contacts(:) !! contacts of the matrices
    real(wp), intent(inout) :: q(:, :) !! q [m/s], shape (d, n)
    real(wp), intent(inout) :: offset(:) !! w [m/s], shape (d n)
    real(wp), intent(out) :: compliance(:, :) !! what is added to the diagonal of W [1/kg], shape (d, n)
    integer :: k, d

    d = size(q, 1)
    do k = 1, size(contacts)
      compliance(:, k) = contacts(k)%compliance(:d)
      q(1, k) = q(1, k) - compliance(1, k)*contacts(k)%cohesion
      if (contacts(k)%has_tangent) cycle
      offset(d*(k - 1) + 2:d*k) = offset(d*(k - 1) + 2:d*k) - q(2:, k)
      q(2:, k) = 0
    end do
  end subroutine finish_velocities
end module sg_problem_matrices
