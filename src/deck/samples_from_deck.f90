!> Samples: many grains from one block of a deck.
module sg_samples_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_generators, only: draw_polygon, draw_radius, insert_at_random, place_on_lattice
  use sg_kinds, only: wp, i4, i8, pi
  use sg_moments, only: polygon_moments
  use sg_ordering, only: order_of
  use sg_random, only: random_t
  use sg_sorting, only: hilbert_key, sort_permutation
  use sg_text, only: to_text
  use sg_values, only: value_t
  use sg_words, only: choice_index
  implicit none
  private
  public :: sample_t, generate_sample, grain_polygon

  !> Grains of one sample, in spatial order
  type :: sample_t
    !> Block of the deck
    integer :: block = 0
    !> Number of grains
    integer :: n = 0
    !> Centres of the circles about the grains [m], shape (2, n), and their radii [m]
    real(wp), allocatable :: centre(:, :), radius(:)
    !> Numbers for the shapes of polygons
    type(random_t) :: random
  end type sample_t

contains

  !> Draw sizes and places of all grains of a block.
  subroutine generate_sample(deck, block, period, sample, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: block !! block of the sample
    real(wp), intent(in) :: period !! period in x [m], 0 for none
    type(sample_t), intent(out) :: sample !! the grains
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    real(wp) :: box(4)
    logical :: is_periodic

    sample%block = block
    allocate (sample%centre(2, 0), sample%radius(0))
    box = box_of(deck, block)
    if (any(box(3:4) <= box(1:2))) then
      call deck%complain(diagnostics, 'the box is empty: it is [x least, y least, x most, y most]', block, 'box')
      return
    end if
    is_periodic = period > 0 .and. all(abs(box([1, 3]) - [0.0_wp, period]) <= 1e-9_wp*period)
    call sample%random%seed(deck%integer(block, 'seed'))
    if (deck%word(block, 'kind') == 'lattice') then
      call fill_lattice(deck, block, box, is_periodic, sample, diagnostics)
    else
      call fill_random(deck, block, box, is_periodic, sample, diagnostics)
    end if
    call order(sample, box)
  end subroutine generate_sample

  !> The box of a sample.
  pure function box_of(deck, block) result(box)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    real(wp) :: box(4)
    type(value_t) :: value

    value = deck%value(block, 'box')
    box = value%numbers(:4)
  end function box_of

  !> Draw the radii of a sample.
  subroutine draw_radii(deck, block, random, radii)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    type(random_t), intent(inout) :: random
    real(wp), intent(out) :: radii(:)
    real(wp) :: range(2)
    integer :: distribution, i

    distribution = choice_index(deck%word(block, 'distribution'), 'uniform|volume|lognormal|constant')
    range = deck%pair(block, 'radius')
    do i = 1, size(radii)
      radii(i) = draw_radius(random, distribution, range)
    end do
  end subroutine draw_radii

  !> Grains on a lattice.
  subroutine fill_lattice(deck, block, box, is_periodic, sample, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    real(wp), intent(in) :: box(4)
    logical, intent(in) :: is_periodic
    type(sample_t), intent(inout) :: sample
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: range(2), pitch, room, angle
    integer :: wanted, i

    range = deck%pair(block, 'radius')
    if (deck%word(block, 'distribution') == 'constant') range(2) = range(1)
    pitch = 2*range(2)*deck%number(block, 'spacing')
    wanted = 10000000
    if (deck%is_given(block, 'count')) wanted = deck%integer(block, 'count')
    call place_on_lattice(box, pitch, deck%word(block, 'arrangement') == 'triangular', is_periodic, wanted, sample%centre)
    sample%n = size(sample%centre, 2)
    if (deck%is_given(block, 'count') .and. sample%n < wanted) then
      call deck%complain(diagnostics, 'the box is too small: its lattice holds '//to_text(sample%n)//' of '//to_text(wanted)// &
                         ' grains', block, 'count')
    else if (sample%n == 0) then
      call deck%complain(diagnostics, 'the box is too small for one grain', block, 'box')
    end if
    room = deck%number(block, 'jitter')*(pitch - 2*range(2))/2
    deallocate (sample%radius)
    allocate (sample%radius(sample%n))
    call draw_radii(deck, block, sample%random, sample%radius)
    do i = 1, sample%n
      angle = sample%random%uniform(0.0_wp, 2*pi)
      sample%centre(:, i) = sample%centre(:, i) + room*sample%random%uniform()*[cos(angle), sin(angle)]
    end do
  end subroutine fill_lattice

  !> Grains at random places.
  subroutine fill_random(deck, block, box, is_periodic, sample, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    real(wp), intent(in) :: box(4)
    logical, intent(in) :: is_periodic
    type(sample_t), intent(inout) :: sample
    type(diagnostics_t), intent(inout) :: diagnostics
    integer, parameter :: most = 10000000
    real(wp) :: area, least(2)
    integer :: n

    if (deck%is_given(block, 'count') .eqv. deck%is_given(block, 'fill')) then
      call deck%complain(diagnostics, 'a random [[sample]] needs either "count" or "fill"', block)
      return
    end if
    area = (box(3) - box(1))*(box(4) - box(2))
    least = deck%pair(block, 'radius')
    if (deck%is_given(block, 'count')) then
      n = deck%integer(block, 'count')
      if (real(n, wp)*pi*least(1)**2 > area) then
        call deck%complain(diagnostics, 'the box is too full: '//to_text(n)//' grains cover more than all of it', block, 'box')
        return
      end if
    else
      area = deck%number(block, 'fill')*area
      if (area/(pi*least(1)**2) > most) then
        call deck%complain(diagnostics, 'this box would hold more than '//to_text(most)//' grains', block, 'fill')
        return
      end if
      n = int(area/(pi*least(1)**2)) + 1
    end if
    deallocate (sample%radius)
    allocate (sample%radius(n))
    call draw_radii(deck, block, sample%random, sample%radius)
    if (deck%is_given(block, 'fill')) sample%radius = sample%radius(:enough(sample%radius, area))
    ! Largest first: late grains are small and still find room.
    sample%radius = sample%radius(order_of(-sample%radius))
    call insert_at_random(sample%random, sample%radius, box, deck%number(block, 'clearance'), is_periodic, sample%centre, n)
    if (n < size(sample%radius)) then
      call deck%complain(diagnostics, 'the box is too full: '//to_text(n)//' of '//to_text(size(sample%radius))// &
                         ' grains found room; random insertion rarely passes a fill of 0.5', block, 'box')
      return
    end if
    sample%n = n
  end subroutine fill_random

  !> How many circles, from the first on, cover an area.
  pure integer function enough(radii, area) result(n)
    real(wp), intent(in) :: radii(:), area
    real(wp) :: covered

    covered = 0
    do n = 1, size(radii) - 1
      covered = covered + pi*radii(n)**2
      if (covered >= area) return
    end do
  end function enough

  !> Put grains in spatial order.
  subroutine order(sample, box)
    type(sample_t), intent(inout) :: sample
    real(wp), intent(in) :: box(4)
    integer(i8), allocatable :: keys(:)
    integer(i4), allocatable :: permutation(:)
    integer :: i
    real(wp) :: extent

    extent = maxval(box(3:4) - box(1:2))
    allocate (keys(sample%n))
    do i = 1, sample%n
      keys(i) = hilbert_key((sample%centre(:, i) - box(1:2))/extent)
    end do
    permutation = sort_permutation(keys)
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
    integer :: sides(2)
    real(wp) :: area, moment, offset(2)

    sides = nint(deck%pair(sample%block, 'sides'))
    sides(1) = min(sides(2), sides(1) + int(sample%random%uniform()*real(sides(2) - sides(1) + 1, wp)))
    call draw_polygon(sample%random, sides(1), sample%radius(i), vertices)
    call polygon_moments(vertices, area, offset, moment)
    vertices = vertices - spread(offset, 2, size(vertices, 2))
    centre = sample%centre(:, i) + offset
  end subroutine grain_polygon
end module sg_samples_from_deck
