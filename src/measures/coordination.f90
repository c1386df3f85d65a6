!> How many neighbours carry a grain, and by how many points pairs touch (doc/theory/indicators.md, "Coordination").
!!
!! Two bodies touch when a contact between them carries a positive normal impulse. A rattler is a grain with fewer
!! than two touching neighbours, in the plane and in space [Thornton2000]; it is taken away once, not again and again, since a
!! column under its own weight would otherwise unravel from its top.
!!
!! Contacts of one grain may lie on several ranks. Its neighbours are then added up on its owner rank and sent to all copies,
!! between `neighbours_of` and `coordination_sums`.
module sg_coordination
  use sg_bodies, only: bodies_t
  use sg_body_kinds, only: body_kind_name, body_kinds
  use sg_contactors, only: contactors_t
  use sg_contacts, only: contacts_t, normal_impulses
  use sg_kinds, only: wp, i4
  use sg_sorting, only: group_items
  use sg_tally, only: pass_columns, pass_sums, ratio, tally_t
  implicit none
  private
  public :: measure_coordination, measure_kinds_of_pairs, measure_by_kind, measure_rattlers, touching_t, touching_pairs
  public :: neighbours_of

  !> Numbers of `coordination_sums`
  integer, parameter :: n_coordination_sums = 10

  !> Pairs of bodies that touch
  type :: touching_t
    !> The two bodies, shape (2, pairs), and by how many points they touch, shape (pairs)
    integer(i4), allocatable :: body(:, :)
    integer, allocatable :: points(:)
  end type touching_t

contains

  !> Neighbours of grains, and pairs of bodies by the number of points at which they touch; in the plane three mean three or more.
  pure subroutine measure_coordination(bodies, touching, neighbours, tally)
    type(bodies_t), intent(in) :: bodies !! bodies of this rank
    type(touching_t), intent(in) :: touching !! pairs that touch
    real(wp), intent(in) :: neighbours(:) !! neighbours of each body over all ranks, of copies too
    type(tally_t), intent(inout) :: tally !! tally of the measure
    real(wp) :: sums(n_coordination_sums)

    if (tally%pass == pass_sums) then
      call tally%sums%put('coordination', coordination_sums(touching, bodies%is_grain, bodies%n_own, neighbours))
    else if (tally%pass == pass_columns) then
      sums = tally%sums%get('coordination', n_coordination_sums)
      if (bodies%dimension == 2) sums(3) = sums(3) + sums(4)
      call tally%add('coordination', ratio(sums(7), sums(5)))
      call tally%add('coordination_without_rattlers', ratio(sums(8), sums(6)))
      call tally%add('single_contacts', sums(1), is_count=.true.)
      call tally%add('double_contacts', sums(2), is_count=.true.)
      call tally%add('triple_contacts', sums(3), is_count=.true.)
    end if
  end subroutine measure_coordination

  !> Number of rattlers, and in space of pairs that touch at four points or more: from the sums of `measure_coordination`.
  pure subroutine measure_rattlers(dimension, tally)
    integer, intent(in) :: dimension !! of space
    type(tally_t), intent(inout) :: tally !! tally of the measure
    real(wp) :: sums(n_coordination_sums)

    if (tally%pass /= pass_columns) return
    sums = tally%sums%get('coordination', n_coordination_sums)
    call tally%add('rattlers', sums(5) - sums(6), is_count=.true.)
    if (dimension == 3) call tally%add('quadruple_contacts', sums(4), is_count=.true.)
  end subroutine measure_rattlers

  !> Mean number of grains that a grain touches, and of walls: their sum is the coordination; from the sums of
  !! `measure_coordination`.
  pure subroutine measure_kinds_of_pairs(tally)
    type(tally_t), intent(inout) :: tally !! tally of the measure
    real(wp) :: sums(n_coordination_sums)

    if (tally%pass /= pass_columns) return
    sums = tally%sums%get('coordination', n_coordination_sums)
    call tally%add('grain_coordination', ratio(2*sums(9), sums(5)))
    call tally%add('wall_coordination', ratio(sums(10), sums(5)))
  end subroutine measure_kinds_of_pairs

  !> Mean number of touching neighbours of the grains of each kind, walls included; columns only where the scene has several kinds.
  pure subroutine measure_by_kind(bodies, contactors, neighbours, tally)
    type(bodies_t), intent(in) :: bodies !! bodies of this rank
    type(contactors_t), intent(in) :: contactors !! their shapes
    real(wp), intent(in) :: neighbours(:) !! neighbours of each body over all ranks, of copies too
    type(tally_t), intent(inout) :: tally !! tally of the measure
    character(len=:), allocatable :: name
    integer :: i

    if (.not. allocated(tally%kinds)) return
    associate (n => size(tally%kinds))
      if (tally%pass == pass_sums) then
        call tally%sums%put('by kind', sums_by_kind(bodies, contactors, neighbours, tally%kinds))
      else if (tally%pass == pass_columns) then
        associate (sums => reshape(tally%sums%get('by kind', 2*n), [2, n]))
          do i = 1, n
            name = body_kind_name(tally%kinds(i))
            if (index(name, ' ') > 0) name(index(name, ' '):index(name, ' ')) = '_'
            call tally%add('coordination_'//name, ratio(sums(1, i), sums(2, i)))
          end do
        end associate
      end if
    end associate
  end subroutine measure_by_kind

  !> What this rank adds for each kind: neighbours of its grains, and how many these are.
  pure function sums_by_kind(bodies, contactors, neighbours, kinds) result(sums)
    type(bodies_t), intent(in) :: bodies
    type(contactors_t), intent(in) :: contactors
    real(wp), intent(in) :: neighbours(:)
    integer, intent(in) :: kinds(:)
    real(wp) :: sums(2*size(kinds))
    logical :: is_one(bodies%n_own)
    integer :: i

    associate (kind => body_kinds(contactors, bodies%n))
      do i = 1, size(kinds)
        is_one = bodies%is_grain(:bodies%n_own) .and. kind(:bodies%n_own) == kinds(i)
        sums(2*i - 1) = sum(neighbours(:bodies%n_own), mask=is_one)
        sums(2*i) = real(count(is_one), wp)
      end do
    end associate
  end function sums_by_kind

  !> Neighbours that a body touches through this rank's contacts; those of all ranks must be added up on its owner rank.
  pure function neighbours_of(touching, n_bodies) result(neighbours)
    type(touching_t), intent(in) :: touching !! pairs that touch
    integer, intent(in) :: n_bodies !! number of bodies
    real(wp) :: neighbours(n_bodies)
    integer :: i

    neighbours = 0
    do i = 1, size(touching%points)
      associate (a => touching%body(1, i), b => touching%body(2, i))
        neighbours(a) = neighbours(a) + 1
        if (b /= a) neighbours(b) = neighbours(b) + 1
      end associate
    end do
  end function neighbours_of

  !> What this rank adds: pairs by one to four points, its grains and how many of them are carried, neighbours of its grains,
  !! and grains in pairs without rattlers; pairs of grains, and of a grain and a wall.
  pure function coordination_sums(touching, is_grain, n_own, neighbours) result(sums)
    type(touching_t), intent(in) :: touching
    logical, intent(in) :: is_grain(:)
    integer, intent(in) :: n_own
    real(wp), intent(in) :: neighbours(:)
    real(wp) :: sums(n_coordination_sums)
    logical :: carries(size(is_grain))
    integer :: i

    do i = 1, 3
      sums(i) = real(count(touching%points == i), wp)
    end do
    sums(4) = real(count(touching%points >= 4), wp)
    carries = is_grain .and. neighbours > 1.5_wp
    sums(5) = real(count(is_grain(:n_own)), wp)
    sums(6) = real(count(carries(:n_own)), wp)
    sums(7) = sum(neighbours(:n_own), mask=is_grain(:n_own))
    sums(8:10) = 0
    do i = 1, size(touching%points)
      associate (a => touching%body(1, i), b => touching%body(2, i))
        if (is_grain(a) .and. is_grain(b)) sums(9) = sums(9) + 1
        if (is_grain(a) .neqv. is_grain(b)) sums(10) = sums(10) + 1
        if ((is_grain(a) .and. .not. carries(a)) .or. (is_grain(b) .and. .not. carries(b))) cycle
        sums(8) = sums(8) + merge(1.0_wp, 0.0_wp, is_grain(a)) + merge(1.0_wp, 0.0_wp, is_grain(b))
      end associate
    end do
  end function coordination_sums

  !> Pairs of bodies that touch, and by how many points; all contacts of a pair are on one rank.
  pure function touching_pairs(contacts, n_bodies) result(pairs)
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    integer, intent(in) :: n_bodies !! number of bodies
    type(touching_t) :: pairs
    integer(i4), allocatable :: lower(:), body(:, :)
    integer, allocatable :: first(:), item(:), points(:), pair_of(:)
    real(wp), allocatable :: normal(:)
    integer :: k, i, n, n_before, upper

    allocate (lower(contacts%n))
    call normal_impulses(contacts, normal)
    do k = 1, contacts%n
      lower(k) = merge(min(contacts%body(1, k), contacts%body(2, k)), 0_i4, normal(k) > 0)
    end do
    call group_items(lower, n_bodies, first, item)
    allocate (body(2, size(item)), points(size(item)))
    ! The pair that was last found for each body: of the present lower body, or of one before.
    allocate (pair_of(n_bodies), source=0)
    n = 0
    do i = 1, n_bodies
      n_before = n
      do k = first(i), first(i + 1) - 1
        upper = max(contacts%body(1, item(k)), contacts%body(2, item(k)))
        if (pair_of(upper) <= n_before) then
          n = n + 1
          pair_of(upper) = n
          body(:, n) = [int(i, i4), int(upper, i4)]
          points(n) = 0
        end if
        points(pair_of(upper)) = points(pair_of(upper)) + 1
      end do
    end do
    pairs%body = body(:, :n)
    pairs%points = points(:n)
  end function touching_pairs
end module sg_coordination
