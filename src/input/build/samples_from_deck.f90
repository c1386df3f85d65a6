!> Samples: many grains of the plane or of space from one block of a deck.
module sg_samples_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t, error_t
  use sg_census, only: census_t
  use sg_generators, only: draw_polygon, draw_radius
  use sg_insertion, only: insert_at_random
  use sg_kinds, only: wp, i4, i8, pi
  use sg_lattice, only: lattice_t, open_lattice, place_on_lattice
  use sg_lattice_slice, only: shift_grain, sizes_t, slice_t, take_slice
  use sg_memory, only: bytes_per_grain, gigabytes, memory_t
  use sg_moments, only: polygon_moments
  use sg_ordering, only: order_of
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: random_polyhedron
  use sg_random, only: random_t
  use sg_sorting, only: hilbert_order
  use sg_text, only: to_text
  use sg_values, only: value_t
  use sg_words, only: choice_index
  implicit none
  private
  public :: sample_t, generate_sample, grain_polygon, grain_polyhedron

  !> Grains of one sample, in spatial order: all of them, or those that one of several ranks keeps
  type :: sample_t
    !> Block of the deck
    integer :: block = 0
    !> Number of grains
    integer :: n = 0
    !> First and last grain that this rank keeps
    integer :: first = 1, last = 0
    !> Centres of the circles or spheres about the grains [m], shape (dimension, listed), and their radii [m]; grains before the
    !! first one listed: either all grains are listed, or those that this rank keeps
    real(wp), allocatable :: centre(:, :), radius(:)
    integer :: before = 0
    !> Numbers for the shapes of polygons and polyhedra
    type(random_t) :: random
  end type sample_t

  !> Grains of a sample at most
  integer, parameter :: most = 10000000

contains

  !> Draw sizes and places of all grains of a block. Of round grains on a lattice several ranks need never list all.
  subroutine generate_sample(deck, block, period, may_stream, sample, census, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: block !! block of the sample
    real(wp), intent(in) :: period(2) !! periods in x and y [m], 0 for none
    logical, intent(in) :: may_stream !! can a rank do without the grains of others?
    type(sample_t), intent(out) :: sample !! the grains
    type(census_t), intent(inout) :: census !! learns about grains that are not listed
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=*), parameter :: boxes(2:3) = [character(len=50) :: 'x least, y least, x most, y most', &
                                                 'x least, y least, z least, x most, y most, z most']
    type(value_t) :: value
    real(wp) :: box(2*deck%dimension)
    logical :: is_periodic(deck%dimension - 1), is_piece

    sample%block = block
    value = deck%value(block, 'box')
    associate (d => deck%dimension)
      allocate (sample%centre(d, 0), sample%radius(0))
      box = value%numbers(:2*d)
      if (any(box(d + 1:) <= box(:d))) then
        call deck%complain(diagnostics, 'the box is empty: it is ['//trim(boxes(d))//']', block, 'box')
        return
      end if
      associate (along => period(:d - 1))
        is_periodic = along > 0 .and. abs(box(:d - 1)) <= 1e-9_wp*along .and. abs(box(d + 1:2*d - 1) - along) <= 1e-9_wp*along
      end associate
    end associate
    call sample%random%seed(deck%integer(block, 'seed'))
    if (deck%word(block, 'kind') == 'lattice') then
      is_piece = may_stream .and. any(deck%word(block, 'shape') == ['disk  ', 'sphere'])
      call fill_lattice(deck, box, is_periodic, period, is_piece, sample, census, diagnostics)
      if (is_piece) return
    else
      call fill_random(deck, block, box, is_periodic, sample, diagnostics)
    end if
    call order(sample, box)
    sample%first = int(int(sample%n, i8)*int(deck%rank, i8)/int(deck%ranks, i8)) + 1
    sample%last = int(int(sample%n, i8)*int(deck%rank + 1, i8)/int(deck%ranks, i8))
  end subroutine generate_sample

  !> Draw the radii of a sample.
  subroutine draw_radii(deck, sample, n)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(inout) :: sample
    integer, intent(in) :: n
    real(wp) :: range(2)
    integer :: distribution, i

    distribution = distribution_of(deck, sample%block)
    range = deck%pair(sample%block, 'radius')
    deallocate (sample%radius)
    allocate (sample%radius(n))
    do i = 1, n
      sample%radius(i) = draw_radius(sample%random, distribution, range, deck%dimension)
    end do
  end subroutine draw_radii

  !> Grains on a lattice: a piece of it, or all.
  subroutine fill_lattice(deck, box, is_periodic, period, is_piece, sample, census, diagnostics)
    type(deck_t), intent(in) :: deck
    real(wp), intent(in) :: box(:), period(2)
    logical, intent(in) :: is_periodic(:), is_piece
    type(sample_t), intent(inout) :: sample
    type(census_t), intent(inout) :: census
    type(diagnostics_t), intent(inout) :: diagnostics
    type(lattice_t) :: lattice
    real(wp) :: range(2), pitch, room
    integer :: wanted, i, arrangement
    logical :: is_refused

    associate (block => sample%block)
      range = deck%pair(block, 'radius')
      if (deck%word(block, 'distribution') == 'constant') range(2) = range(1)
      pitch = 2*range(2)*deck%number(block, 'spacing')
      wanted = most
      if (deck%is_given(block, 'count')) then
        wanted = deck%integer(block, 'count')
        call check_room(deck, block, real(wanted, wp), 'count', diagnostics, is_refused)
      else
        associate (room => box(deck%dimension + 1:) - box(:deck%dimension))
          call check_room(deck, block, product(max(1.0_wp, aint(room/pitch))), 'radius', diagnostics, is_refused)
        end associate
      end if
      if (is_refused) return
      arrangement = choice_index(deck%word(block, 'arrangement'), trim(merge('square|triangular  ', 'cubic|hexagonal|fcc', &
                                                                             deck%dimension == 2)))
      call open_lattice(lattice, box, pitch, arrangement, is_periodic, wanted)
      sample%n = lattice%count()
      if (deck%is_given(block, 'count') .and. sample%n < wanted) then
        call deck%complain(diagnostics, 'the box is too small: its lattice holds '//to_text(sample%n)//' of '// &
                           to_text(wanted)//' grains', block, 'count')
      else if (sample%n == 0) then
        call deck%complain(diagnostics, 'the box is too small for one grain', block, 'box')
      end if
      room = deck%number(block, 'jitter')*(pitch - 2*range(2))/2
    end associate
    if (is_piece) then
      if (sample%n > 0) call take_piece(deck, lattice, room, box, period, sample, census)
      return
    end if
    call place_on_lattice(box, pitch, arrangement, is_periodic, wanted, sample%centre)
    call draw_radii(deck, sample, sample%n)
    do i = 1, sample%n
      call shift_grain(sample%centre(:, i), room, sample%random)
    end do
  end subroutine fill_lattice

  !> The piece of a lattice that this rank keeps.
  subroutine take_piece(deck, lattice, room, box, period, sample, census)
    type(deck_t), intent(in) :: deck
    type(lattice_t), intent(inout) :: lattice
    real(wp), intent(in) :: room, box(:), period(2)
    type(sample_t), intent(inout) :: sample
    type(census_t), intent(inout) :: census
    type(slice_t) :: slice

    call take_slice(lattice, sizes_t(distribution_of(deck, sample%block), deck%pair(sample%block, 'radius'), room), &
                    sample%random, box, period, deck%rank, deck%ranks, slice, census)
    call move_alloc(slice%centre, sample%centre)
    call move_alloc(slice%radius, sample%radius)
    sample%before = slice%before
    sample%first = slice%before + 1
    sample%last = slice%before + size(sample%radius)
  end subroutine take_piece

  !> How radii are spread.
  integer function distribution_of(deck, block) result(distribution)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block

    distribution = choice_index(deck%word(block, 'distribution'), 'uniform|volume|lognormal|constant')
  end function distribution_of

  !> Grains at random places.
  subroutine fill_random(deck, block, box, is_periodic, sample, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    real(wp), intent(in) :: box(:)
    logical, intent(in) :: is_periodic(:)
    type(sample_t), intent(inout) :: sample
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: volume, least
    integer :: n
    logical :: is_refused

    if (deck%is_given(block, 'count') .eqv. deck%is_given(block, 'fill')) then
      call deck%complain(diagnostics, 'a random [[sample]] needs either "count" or "fill"', block)
      return
    end if
    volume = product(box(deck%dimension + 1:) - box(:deck%dimension))
    least = volume_of(minval(deck%pair(block, 'radius')), deck%dimension)
    if (deck%is_given(block, 'count')) then
      n = deck%integer(block, 'count')
      if (real(n, wp)*least > volume) then
        call deck%complain(diagnostics, 'the box is too full: '//to_text(n)//' grains '// &
                           trim(merge('cover', 'fill ', deck%dimension == 2))//' more than all of it', block, 'box')
        return
      end if
      call check_room(deck, block, real(n, wp), 'count', diagnostics, is_refused)
    else
      volume = deck%number(block, 'fill')*volume
      call check_room(deck, block, volume/least, 'fill', diagnostics, is_refused)
      if (.not. is_refused) n = int(volume/least) + 1
    end if
    if (is_refused) return
    call draw_radii(deck, sample, n)
    if (deck%is_given(block, 'fill')) sample%radius = sample%radius(:enough(sample%radius, volume, deck%dimension))
    ! Largest first: late grains are small and still find room.
    sample%radius = sample%radius(order_of(-sample%radius))
    call insert_at_random(sample%random, sample%radius, box, deck%number(block, 'clearance'), is_periodic, sample%centre, n)
    if (n < size(sample%radius)) then
      call deck%complain(diagnostics, 'the box is too full: '//to_text(n)//' of '//to_text(size(sample%radius))// &
                         ' grains found room; random insertion rarely passes a fill of '// &
                         trim(merge('0.5 ', '0.35', deck%dimension == 2)), block, 'box')
      return
    end if
    sample%n = n
  end subroutine fill_random

  !> Refuse more grains than a sample may hold, or than there is memory for, before one of them is made.
  subroutine check_room(deck, block, grains, key, diagnostics, is_refused)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    real(wp), intent(in) :: grains
    character(len=*), intent(in) :: key !! key of the block to blame
    type(diagnostics_t), intent(inout) :: diagnostics
    logical, intent(out) :: is_refused
    type(memory_t) :: memory
    character(len=:), allocatable :: limit
    integer(i8) :: left
    real(wp) :: bytes

    is_refused = .true.
    if (grains > most) then
      call deck%complain(diagnostics, 'this sample would hold '//to_text(grains, 2)//' grains, more than '//to_text(most), &
                         block, key)
      return
    end if
    ! Each rank keeps its share; those of one machine are not known here.
    bytes = grains*real(bytes_per_grain, wp)/real(deck%ranks, wp)
    is_refused = .not. memory%fits(int(bytes, i8))
    if (.not. is_refused) return
    call memory%left(left, limit)
    call deck%complain(diagnostics, 'this sample of '//to_text(nint(grains))//' grains needs about '//gigabytes(bytes)//', and '// &
                       limit//' leaves '//gigabytes(real(left, wp)), block, key)
  end subroutine check_room

  !> Area of a circle, or volume of a sphere.
  pure real(wp) function volume_of(radius, dimension) result(volume)
    real(wp), intent(in) :: radius
    integer, intent(in) :: dimension

    if (dimension == 2) then
      volume = pi*radius**2
    else
      volume = 4*pi/3*radius**3
    end if
  end function volume_of

  !> How many grains, from the first on, fill an area or a volume.
  pure integer function enough(radii, volume, dimension) result(n)
    real(wp), intent(in) :: radii(:), volume
    integer, intent(in) :: dimension
    real(wp) :: filled

    filled = 0
    do n = 1, size(radii) - 1
      filled = filled + volume_of(radii(n), dimension)
      if (filled >= volume) return
    end do
  end function enough

  !> Put grains in spatial order.
  subroutine order(sample, box)
    type(sample_t), intent(inout) :: sample
    real(wp), intent(in) :: box(:)
    integer(i4), allocatable :: permutation(:)
    integer :: d

    d = size(box)/2
    permutation = hilbert_order(sample%centre(:, :sample%n), box(:d), maxval(box(d + 1:) - box(:d)))
    sample%centre = sample%centre(:, permutation)
    sample%radius = sample%radius(permutation)
  end subroutine order

  !> Shape of one polygonal grain: vertices about the centre of mass, and that centre.
  subroutine grain_polygon(deck, sample, i, vertices, centre)
    type(deck_t), intent(in) :: deck !! checked deck
    type(sample_t), intent(inout) :: sample !! its sample
    integer, intent(in) :: i !! grain of the sample
    real(wp), allocatable, intent(out) :: vertices(:, :) !! about the centre of mass [m], shape (2, n)
    real(wp), intent(out) :: centre(2) !! centre of mass [m]
    real(wp) :: area, moment, offset(2)
    integer :: n

    n = drawn_count(deck, sample, 'sides')
    call draw_polygon(sample%random, n, sample%radius(i - sample%before), vertices)
    call polygon_moments(vertices, area, offset, moment)
    vertices = vertices - spread(offset, 2, size(vertices, 2))
    centre = sample%centre(:, i - sample%before) + offset
  end subroutine grain_polygon

  !> Shape of one polyhedral grain, in the frame of its ellipsoid.
  subroutine grain_polyhedron(deck, sample, i, shape, error)
    type(deck_t), intent(in) :: deck !! checked deck
    type(sample_t), intent(inout) :: sample !! its sample
    integer, intent(in) :: i !! grain of the sample
    type(polyhedron_t), intent(out) :: shape !! polyhedron
    type(error_t), allocatable, intent(out) :: error !! set when the numbers make none
    real(wp) :: elongation(2), least
    integer :: n

    n = drawn_count(deck, sample, 'vertices')
    elongation = deck%pair(sample%block, 'elongation')
    least = 1/sample%random%uniform(elongation(1), elongation(2))
    call random_polyhedron(n, sample%radius(i - sample%before)*[1.0_wp, sample%random%uniform(least, 1.0_wp), least], &
                           sample%random, shape, error)
  end subroutine grain_polyhedron

  !> A number of vertices within the range that the deck gives.
  integer function drawn_count(deck, sample, name) result(n)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(inout) :: sample
    character(len=*), intent(in) :: name
    integer :: range(2)

    range = nint(deck%pair(sample%block, name))
    n = min(range(2), range(1) + int(sample%random%uniform()*real(range(2) - range(1) + 1, wp)))
  end function drawn_count
end module sg_samples_from_deck
