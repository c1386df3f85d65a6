!> Samples in space: many grains from one block of a deck.
module sg_solid_samples_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t, error_t
  use sg_generators, only: draw_radius
  use sg_kinds, only: wp, i4, i8, pi
  use sg_ordering, only: order_of
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: random_polyhedron
  use sg_random, only: random_t
  use sg_sorting, only: hilbert_key_in_space, sort_permutation
  use sg_space_generators, only: insert_in_space, place_on_space_lattice, random_direction
  use sg_text, only: to_text
  use sg_values, only: value_t
  use sg_words, only: choice_index
  implicit none
  private
  public :: solid_sample_t, generate_solid_sample, grain_polyhedron

  !> Grains of one sample, in spatial order
  type :: solid_sample_t
    !> Block of the deck
    integer :: block = 0
    !> Number of grains
    integer :: n = 0
    !> Centres of the spheres about the grains [m], shape (3, n), and their radii [m]
    real(wp), allocatable :: centre(:, :), radius(:)
    !> Numbers for the shapes of polyhedra
    type(random_t) :: random
  end type solid_sample_t

contains

  !> Draw sizes and places of all grains of a block.
  subroutine generate_solid_sample(deck, block, period, sample, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: block !! block of the sample
    real(wp), intent(in) :: period(2) !! periods in x and y [m], 0 for none
    type(solid_sample_t), intent(out) :: sample !! the grains
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(value_t) :: value
    real(wp) :: box(6)
    logical :: is_periodic(2)

    sample%block = block
    allocate (sample%centre(3, 0), sample%radius(0))
    value = deck%value(block, 'box')
    box = value%numbers(:6)
    if (any(box(4:6) <= box(1:3))) then
      call deck%complain(diagnostics, 'the box is empty: it is [x least, y least, z least, x most, y most, z most]', block, 'box')
      return
    end if
    is_periodic = period > 0 .and. abs(box(1:2)) <= 1e-9_wp*period .and. abs(box(4:5) - period) <= 1e-9_wp*period
    call sample%random%seed(deck%integer(block, 'seed'))
    if (deck%word(block, 'kind') == 'lattice') then
      call fill_lattice(deck, block, box, is_periodic, sample, diagnostics)
    else
      call fill_random(deck, block, box, is_periodic, sample, diagnostics)
    end if
    call order(sample, box)
  end subroutine generate_solid_sample

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
      radii(i) = draw_radius(random, distribution, range, 3)
    end do
  end subroutine draw_radii

  !> Grains on a lattice.
  subroutine fill_lattice(deck, block, box, is_periodic, sample, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    real(wp), intent(in) :: box(6)
    logical, intent(in) :: is_periodic(2)
    type(solid_sample_t), intent(inout) :: sample
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: range(2), pitch, room
    integer :: wanted, i

    range = deck%pair(block, 'radius')
    if (deck%word(block, 'distribution') == 'constant') range(2) = range(1)
    pitch = 2*range(2)*deck%number(block, 'spacing')
    wanted = 10000000
    if (deck%is_given(block, 'count')) wanted = deck%integer(block, 'count')
    call place_on_space_lattice(box, pitch, choice_index(deck%word(block, 'arrangement'), 'cubic|hexagonal|fcc'), is_periodic, &
                                wanted, sample%centre)
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
    if (.not. room > 0) return
    do i = 1, sample%n
      sample%centre(:, i) = sample%centre(:, i) + room*sample%random%uniform()**(1.0_wp/3)*random_direction(sample%random)
    end do
  end subroutine fill_lattice

  !> Grains at random places.
  subroutine fill_random(deck, block, box, is_periodic, sample, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    real(wp), intent(in) :: box(6)
    logical, intent(in) :: is_periodic(2)
    type(solid_sample_t), intent(inout) :: sample
    type(diagnostics_t), intent(inout) :: diagnostics
    integer, parameter :: most = 10000000
    real(wp) :: volume, least
    integer :: n

    if (deck%is_given(block, 'count') .eqv. deck%is_given(block, 'fill')) then
      call deck%complain(diagnostics, 'a random [[sample]] needs either "count" or "fill"', block)
      return
    end if
    volume = product(box(4:6) - box(1:3))
    least = 4*pi/3*minval(deck%pair(block, 'radius'))**3
    if (deck%is_given(block, 'count')) then
      n = deck%integer(block, 'count')
      if (real(n, wp)*least > volume) then
        call deck%complain(diagnostics, 'the box is too full: '//to_text(n)//' grains fill more than all of it', block, 'box')
        return
      end if
    else
      volume = deck%number(block, 'fill')*volume
      if (volume/least > most) then
        call deck%complain(diagnostics, 'this box would hold more than '//to_text(most)//' grains', block, 'fill')
        return
      end if
      n = int(volume/least) + 1
    end if
    deallocate (sample%radius)
    allocate (sample%radius(n))
    call draw_radii(deck, block, sample%random, sample%radius)
    if (deck%is_given(block, 'fill')) sample%radius = sample%radius(:enough(sample%radius, volume))
    ! Largest first: late grains are small and still find room.
    sample%radius = sample%radius(order_of(-sample%radius))
    call insert_in_space(sample%random, sample%radius, box, deck%number(block, 'clearance'), is_periodic, sample%centre, n)
    if (n < size(sample%radius)) then
      call deck%complain(diagnostics, 'the box is too full: '//to_text(n)//' of '//to_text(size(sample%radius))// &
                         ' grains found room; random insertion rarely passes a fill of 0.35', block, 'box')
      return
    end if
    sample%n = n
  end subroutine fill_random

  !> How many spheres, from the first on, fill a volume.
  pure integer function enough(radii, volume) result(n)
    real(wp), intent(in) :: radii(:), volume
    real(wp) :: filled

    filled = 0
    do n = 1, size(radii) - 1
      filled = filled + 4*pi/3*radii(n)**3
      if (filled >= volume) return
    end do
  end function enough

  !> Put grains in spatial order.
  subroutine order(sample, box)
    type(solid_sample_t), intent(inout) :: sample
    real(wp), intent(in) :: box(6)
    integer(i8), allocatable :: keys(:)
    integer(i4), allocatable :: permutation(:)
    integer :: i
    real(wp) :: extent

    extent = maxval(box(4:6) - box(1:3))
    allocate (keys(sample%n))
    do i = 1, sample%n
      keys(i) = hilbert_key_in_space((sample%centre(:, i) - box(1:3))/extent)
    end do
    permutation = sort_permutation(keys)
    sample%centre = sample%centre(:, permutation)
    sample%radius = sample%radius(permutation)
  end subroutine order

  !> Shape of one polyhedral grain, in the frame of its ellipsoid.
  subroutine grain_polyhedron(deck, sample, i, shape, error)
    type(deck_t), intent(in) :: deck !! checked deck
    type(solid_sample_t), intent(inout) :: sample !! its sample
    integer, intent(in) :: i !! grain of the sample
    type(polyhedron_t), intent(out) :: shape !! polyhedron
    type(error_t), allocatable, intent(out) :: error !! set when the numbers make none
    integer :: count(2)
    real(wp) :: elongation(2), least

    count = nint(deck%pair(sample%block, 'vertices'))
    count(1) = min(count(2), count(1) + int(sample%random%uniform()*real(count(2) - count(1) + 1, wp)))
    elongation = deck%pair(sample%block, 'elongation')
    least = 1/sample%random%uniform(elongation(1), elongation(2))
    call random_polyhedron(count(1), sample%radius(i)*[1.0_wp, sample%random%uniform(least, 1.0_wp), least], sample%random, &
                           shape, error)
  end subroutine grain_polyhedron
end module sg_solid_samples_from_deck
