!> The contact problem of a step as matrices, on any number of ranks: each makes the rows of its own contacts and unknowns, and
!! none holds more than that and what its neighbours have to do with it. On one rank these are all rows.
!!
!! W = H^T M^-1 H needs of other ranks' contacts their entries of H on bodies that both push (sg_shared_entries); all else is
!! local. What the matrices are: sg_problem_matrices.
module sg_shared_matrices
  use sg_comm, only: comm_t
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp, i4, i8
  use sg_matrix_pieces, only: matrix_pieces_t, matrix_state_t, triplets_t
  use sg_problem, only: problem_t
  use sg_problem_matrices, only: find_pushed, finish_velocities, mapping_entries, matrices_map_t, take_contacts
  use sg_problem_records, only: body_of, body_record_t, contact_of, contact_record_t
  use sg_records, only: is_in_space
  use sg_shared_entries, only: entries_t, exchange_entries
  use sg_shared_unknowns, only: number_unknowns, shared_unknowns_t
  use sg_sorting, only: sort_permutation
  use sg_sparse, only: multiply_transposed, sparse_from_triplets, sparse_t, transposed
  use sg_sparse_algebra, only: multiply_matrices, rows_of
  use sg_subdomain, only: subdomain_t
  implicit none
  private
  public :: shared_matrices_t, share_matrices, take_solution

  !> One rank's share of a problem, and what its solution is read with
  type :: shared_matrices_t
    !> Its share, with the guess
    type(matrix_pieces_t) :: pieces
    !> Where its contacts come from, and its unknowns
    type(matrices_map_t), private :: map
    type(shared_unknowns_t), private :: unknowns
    !> H, unknowns of this rank by components of its contacts; compliance of these [1/kg]
    type(sparse_t), private :: h
    real(wp), allocatable, private :: compliance(:)
  end type shared_matrices_t

contains

  !> Make the matrices of a problem that is not solved yet; its impulses are the guess. Collective.
  subroutine share_matrices(problem, subdomain, slot_of, comm, shared, error)
    type(problem_t), intent(in) :: problem !! this rank's contacts; bodies move as without impulses
    type(subdomain_t), intent(in) :: subdomain !! which ranks share which body; not used on one rank
    integer(i4), intent(in) :: slot_of(:) !! slot of each local body
    type(comm_t), intent(inout) :: comm !! the ranks
    type(shared_matrices_t), intent(out) :: shared !! its share
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when a law cannot be expressed so
    type(contact_record_t), allocatable :: contacts(:)
    type(entries_t) :: own, others
    real(wp), allocatable :: pushed(:, :)
    integer(i8) :: before, all

    call take_contacts(problem, shared%map, contacts, error)
    call comm%agree(error)
    if (allocated(error)) return
    shared%pieces%d = merge(3, 2, is_in_space(problem%kind))
    call comm%before(int(size(contacts), i8), before, all)
    call number_unknowns(problem, find_pushed(problem, shared%map), subdomain, slot_of, comm, shared%unknowns)
    if (max(int(shared%pieces%d, i8)*all, shared%unknowns%all) > int(huge(1_i4), i8)) then
      call fail(error, 'the problem has more rows than FCLIB files can count')
      return
    end if
    shared%pieces%all_contacts = int(all)
    shared%pieces%all_unknowns = int(shared%unknowns%all)
    call set_mapping(problem, contacts, int(before), shared, own)
    call exchange_entries(own, shared%unknowns, comm, others, pushed)
    call set_loads(shared%unknowns, pushed, shared%pieces)
    call set_rows(own, others, int(before), contacts, shared, error)
    call comm%agree(error)
    if (allocated(error)) return
    shared%pieces%has_global = comm%all(.not. any(shared%compliance > 0))
    shared%pieces%has_guess = .true.
  end subroutine share_matrices

  !> Set H, the offset w and friction.
  subroutine set_mapping(problem, contacts, before, shared, own)
    type(problem_t), intent(in) :: problem
    type(contact_record_t), intent(in) :: contacts(:)
    integer, intent(in) :: before !! contacts of lower ranks
    type(shared_matrices_t), intent(inout) :: shared
    type(entries_t), intent(out) :: own
    integer :: e, k, i, d

    d = shared%pieces%d
    associate (unknowns => shared%unknowns, h => shared%pieces%h)
      call mapping_entries(problem, contacts, shared%map%contact, unknowns%body, unknowns%of_slot, own%row, own%column, own%value, &
                           shared%pieces%offset)
      own%n = size(own%row)
      call sparse_from_triplets(unknowns%n, d*size(contacts), own%row, own%column, own%value, shared%h)
      allocate (own%impulse(own%n), own%cohesion(own%n), source=0.0_wp)
      do e = 1, own%n
        k = (own%column(e) - 1)/d + 1
        i = own%column(e) - d*(k - 1)
        own%impulse(e) = contacts(k)%impulse(i)
        if (i == 1) own%cohesion(e) = contacts(k)%cohesion
      end do
      own%column = own%column + int(d*before, i4)
      h%row = unknowns%number(own%row)
      h%column = own%column
      ! Copied by its bounds: of a whole list gfortran would first look at those of the one that is not there yet.
      allocate (h%value(own%n))
      h%value(:) = own%value(:own%n)
    end associate
    allocate (shared%pieces%friction(size(contacts)))
    shared%pieces%friction = contacts%friction
  end subroutine set_mapping

  !> Set M, f = M v - H c, and the velocities that the guess makes, of a rank's own unknowns.
  subroutine set_loads(unknowns, pushed, pieces)
    type(shared_unknowns_t), intent(in) :: unknowns
    real(wp), intent(in) :: pushed(:, :) !! H r and H c of them
    type(matrix_pieces_t), intent(inout) :: pieces
    integer :: i

    allocate (pieces%f(unknowns%n_own), pieces%guess%v(unknowns%n_own), pieces%mass%value(unknowns%n_own))
    pieces%mass%row = unknowns%number(:unknowns%n_own)
    pieces%mass%column = pieces%mass%row
    do i = 1, unknowns%n_own
      associate (body => unknowns%body(unknowns%slot(i)), c => unknowns%component(i))
        pieces%mass%value(i) = 1/body%inverse_mass(c)
        pieces%f(i) = body%velocity(c)/body%inverse_mass(c) - pushed(2, i)
        pieces%guess%v(i) = body%velocity(c) + body%inverse_mass(c)*pushed(1, i)
      end associate
    end do
  end subroutine set_loads

  !> Set W, q and what the guess makes of the relative velocities.
  subroutine set_rows(own, others, before, contacts, shared, error)
    type(entries_t), intent(in) :: own, others
    integer, intent(in) :: before !! contacts of lower ranks
    type(contact_record_t), intent(in) :: contacts(:)
    type(shared_matrices_t), intent(inout) :: shared
    type(error_t), allocatable, intent(out) :: error
    type(sparse_t) :: h, moved, w
    integer(i4), allocatable :: number(:), local(:)
    real(wp) :: inverse(shared%unknowns%n), free(shared%unknowns%n), guessed(shared%unknowns%n)
    real(wp), allocatable :: q(:, :), u(:), compliance(:, :)
    integer(i4), allocatable :: row(:)
    integer :: d, n, i

    d = shared%pieces%d
    n = size(contacts)
    call number_columns(others%column, d*before, d*n, number, local)
    call sparse_from_triplets(shared%unknowns%n, d*n + size(number), [own%row, others%row], &
                              [own%column - int(d*before, i4), local], [own%value, others%value], h)
    call set_velocities(own, others, shared%unknowns, shared%pieces, inverse, free, guessed)
    moved = h
    row = rows_of(h)
    moved%value = inverse(row)*moved%value
    call multiply_matrices(transposed(shared%h), moved, w, error)
    if (allocated(error)) return

    allocate (q(d, n), u(d*n), compliance(d, n))
    call multiply_transposed(shared%h, free, u)
    q = reshape(u + shared%pieces%offset, [d, n])
    call finish_velocities(contacts, q, shared%pieces%offset, compliance)
    shared%pieces%q = reshape(q, [d*n])
    shared%compliance = reshape(compliance, [d*n])
    associate (pieces => shared%pieces)
      allocate (pieces%guess%r(d*n))
      do i = 1, n
        pieces%guess%r(d*(i - 1) + 1:d*i) = contacts(i)%impulse(:d)
      end do
      call finish_state(shared, guessed, pieces%guess)
      call take_rows(w, shared%compliance, d*before, number, pieces%w)
    end associate
  end subroutine set_rows

  !> Number the columns of other ranks' contacts behind a rank's own.
  pure subroutine number_columns(column, before, n_own, number, local)
    integer(i4), intent(in) :: column(:) !! in the whole problem
    integer, intent(in) :: before, n_own !! columns of lower ranks, and of this one
    integer(i4), allocatable, intent(out) :: number(:) !! in the whole problem, of columns that are not its own
    integer(i4), allocatable, intent(out) :: local(:) !! among a rank's own and these
    integer(i4), allocatable :: order(:)
    integer :: i, n

    order = sort_permutation(int(column, i8))
    allocate (number(size(column)), local(size(column)))
    n = 0
    do i = 1, size(order)
      associate (c => column(order(i)))
        if (c > before .and. c <= before + n_own) then
          local(order(i)) = c - int(before, i4)
          cycle
        end if
        if (n == 0) then
          n = 1
          number(n) = c
        else if (number(n) /= c) then
          n = n + 1
          number(n) = c
        end if
        local(order(i)) = int(n_own + n, i4)
      end associate
    end do
    number = number(:n)
  end subroutine number_columns

  !> Velocities of all unknowns of a rank: M^-1 f, and those of the guess.
  subroutine set_velocities(own, others, unknowns, pieces, inverse, free, guessed)
    type(entries_t), intent(in) :: own, others
    type(shared_unknowns_t), intent(in) :: unknowns
    type(matrix_pieces_t), intent(in) :: pieces
    real(wp), intent(out) :: inverse(:), free(:), guessed(:)
    integer :: i

    do i = 1, unknowns%n
      associate (body => unknowns%body(unknowns%slot(i)), c => unknowns%component(i))
        inverse(i) = body%inverse_mass(c)
        free(i) = body%velocity(c)
        guessed(i) = body%velocity(c)
      end associate
    end do
    call add(own)
    call add(others)
    ! Those of its own bodies are known from all ranks' entries, also where it has none itself.
    free(:unknowns%n_own) = inverse(:unknowns%n_own)*pieces%f
    guessed(:unknowns%n_own) = pieces%guess%v
  contains
    subroutine add(entries)
      type(entries_t), intent(in) :: entries
      integer :: e

      do e = 1, entries%n
        associate (i => entries%row(e))
          free(i) = free(i) - inverse(i)*entries%value(e)*entries%cohesion(e)
          guessed(i) = guessed(i) + inverse(i)*entries%value(e)*entries%impulse(e)
        end associate
      end do
    end subroutine add
  end subroutine set_velocities

  !> Relative velocities from those of the unknowns and from impulses without cohesion, which is added to these then.
  subroutine finish_state(shared, v, state)
    type(shared_matrices_t), intent(in) :: shared
    real(wp), intent(in) :: v(:) !! of all unknowns of this rank
    type(matrix_state_t), intent(inout) :: state !! its impulses are set
    integer :: k, d

    d = shared%pieces%d
    allocate (state%u(size(state%r)))
    call multiply_transposed(shared%h, v, state%u)
    state%u = state%u + shared%pieces%offset + shared%compliance*state%r
    do k = 1, size(shared%map%cohesion)
      state%r(d*(k - 1) + 1) = state%r(d*(k - 1) + 1) + shared%map%cohesion(k)
    end do
  end subroutine finish_state

  !> Entries of the rows of W of a rank, with compliance on their diagonal, by their numbers in the whole problem.
  subroutine take_rows(w, compliance, before, number, rows)
    type(sparse_t), intent(in) :: w !! rows by a rank's own columns and those of others
    real(wp), intent(in) :: compliance(:) !! [1/kg]
    integer, intent(in) :: before !! columns of lower ranks
    integer(i4), intent(in) :: number(:) !! of the columns that are not its own
    type(triplets_t), intent(out) :: rows
    integer(i4) :: place(size(compliance)), columns(size(compliance) + size(number))
    type(sparse_t) :: stiff
    integer :: i, n

    n = size(compliance)
    place = [(int(i, i4), i=1, n)]
    columns = [place + int(before, i4), number]
    call sparse_from_triplets(n, size(columns), [rows_of(w), place], [w%column, place], [w%value, compliance], stiff)
    rows%row = pack(rows_of(stiff) + int(before, i4), abs(stiff%value) > 0)
    rows%column = columns(pack(stiff%column, abs(stiff%value) > 0))
    rows%value = pack(stiff%value, abs(stiff%value) > 0)
  end subroutine take_rows

  !> Take impulses and velocities of the solved problem as its solution.
  subroutine take_solution(problem, shared)
    type(problem_t), intent(in) :: problem !! problem, solved, all copies of a body with one velocity
    type(shared_matrices_t), intent(inout) :: shared !! its matrices
    type(contact_record_t) :: contact
    type(body_record_t) :: body
    real(wp) :: v(shared%unknowns%n), spin(3)
    integer :: k, i, d

    d = shared%pieces%d
    associate (unknowns => shared%unknowns, state => shared%pieces%solution)
      allocate (state%r(d*size(shared%map%contact)))
      do k = 1, size(shared%map%contact)
        contact = contact_of(problem, int(shared%map%contact(k)))
        state%r(d*(k - 1) + 1:d*k) = contact%impulse(:d)
      end do
      do i = 1, unknowns%n
        body = body_of(problem, int(unknowns%slot(i)))
        if (unknowns%component(i) > 3 .and. body%n == 6) then
          spin = matmul(matmul(body%axes, body%velocity(4:6)), unknowns%body(unknowns%slot(i))%axes)
          v(i) = spin(unknowns%component(i) - 3)
        else
          v(i) = body%velocity(unknowns%component(i))
        end if
      end do
      if (.not. allocated(state%v)) allocate (state%v(unknowns%n_own))
      state%v(:) = v(:unknowns%n_own)
      call finish_state(shared, v, state)
    end associate
    shared%pieces%has_solution = .true.
  end subroutine take_solution
end module sg_shared_matrices
