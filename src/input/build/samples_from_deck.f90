!> Samples: many grains of the plane or of space from one block of a deck.
module sg_samples_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_census, only: census_t
  use sg_grain_templates, only: choose_templates, grain_template_t
  use sg_growth, only: grow_in_box
  use sg_insertion, only: insert_at_random
  use sg_kinds, only: wp, i4, i8
  use sg_lattice, only: lattice_t, open_lattice, place_on_lattice
  use sg_lattice_slice, only: shift_grain, sizes_t, slice_t, take_slice
  use sg_memory, only: bytes_per_grain, gigabytes, memory_t
  use sg_ordering, only: order_of
  use sg_random, only: random_t
  use sg_sample_sizes, only: ball_volume, sample_sizes_t
  use sg_sorting, only: hilbert_order
  use sg_text, only: text_t, to_text
  use sg_values, only: value_as_toml, value_t
  use sg_words, only: choice_index
  implicit none
  private
  public :: sample_t, generate_samples

  !> Grains of one sample, in spatial order: all of them, or those that one of several ranks keeps
  type :: sample_t
    !> Block of the deck
    integer :: block = 0
    !> Number of grains
    integer :: n = 0
    !> Do they enter one after the other, in the order of their numbers, and may their places overlap?
    logical :: is_rain = .false.
    !> When they are there, as the deck writes it: samples that enter at different times do not keep clear of each other
    type(text_t) :: moment
    !> First and last grain that this rank keeps
    integer :: first = 1, last = 0
    !> Centres of the circles or spheres about the grains [m], shape (dimension, listed), and their radii [m]; grains before the
    !! first one listed: either all grains are listed, or those that this rank keeps
    real(wp), allocatable :: centre(:, :), radius(:)
    integer :: before = 0
    !> How they are sized, and of a sieve curve the second and third half axis of each grain over its radius, shape (2, listed)
    type(sample_sizes_t) :: sizes
    real(wp), allocatable :: axes(:, :)
    !> Templates that grains draw from, by number, empty where shapes are made; that of each grain, shape (listed), else unallocated
    integer, allocatable :: templates(:)
    integer(i4), allocatable :: template(:)
    !> Numbers for the shapes of polygons and polyhedra, and for turns of templates
    type(random_t) :: random
  end type sample_t

  !> Grains of a sample at most
  integer, parameter :: most = 10000000

contains

  !> Draw sizes and places of the grains of all samples: those on lattices first, then those at random, which keep clear of the
  !! samples before. Of round grains on a lattice several ranks need never list all.
  subroutine generate_samples(deck, templates, period, may_stream, samples, census, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(grain_template_t), intent(in) :: templates(:) !! all templates
    real(wp), intent(in) :: period(3) !! periods along x, y, z [m], 0 for none
    logical, intent(in) :: may_stream !! can a rank do without the grains of others?
    type(sample_t), allocatable, intent(out) :: samples(:) !! in the order of the deck
    type(census_t), intent(inout) :: census !! learns about grains that are not listed
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    logical :: lists_all
    integer :: i, pass

    call list_samples(deck, samples)
    lists_all = any([(is_random(deck, samples(i)), i=1, size(samples))])
    do pass = 1, 2
      do i = 1, size(samples)
        if (is_random(deck, samples(i)) .eqv. pass == 2) &
          call generate_sample(deck, templates, samples, i, period, may_stream .and. .not. lists_all, census, diagnostics)
      end do
    end do
  end subroutine generate_samples

  !> List the samples in the order of the deck, then rains.
  subroutine list_samples(deck, samples)
    type(deck_t), intent(in) :: deck
    type(sample_t), allocatable, intent(out) :: samples(:)
    type(value_t) :: at
    integer :: b, i, pass

    allocate (samples(deck%count_of('sample') + deck%count_of('rain')))
    i = 0
    do pass = 1, 2
      do b = 1, deck%n
        if (.not. deck%is_in(b, trim(merge('sample', 'rain  ', pass == 1)))) cycle
        i = i + 1
        samples(i)%block = b
        samples(i)%is_rain = pass == 2
        samples(i)%moment%s = ''
        if (.not. deck%is_given(b, 'at')) cycle
        at = deck%value(b, 'at')
        samples(i)%moment%s = value_as_toml(at, deck%table%keys(at%key))
      end do
    end do
  end subroutine list_samples

  !> Are the grains of a sample placed at random?
  pure logical function is_random(deck, sample)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(in) :: sample

    is_random = sample%is_rain
    if (.not. is_random) is_random = deck%word(sample%block, 'kind') /= 'lattice'
  end function is_random

  !> Draw sizes and places of the grains of one sample.
  subroutine generate_sample(deck, templates, samples, i, period, may_stream, census, diagnostics)
    type(deck_t), intent(in) :: deck
    type(grain_template_t), intent(in) :: templates(:)
    type(sample_t), intent(inout) :: samples(:) !! grains of those before are there
    integer, intent(in) :: i
    real(wp), intent(in) :: period(3)
    logical, intent(in) :: may_stream
    type(census_t), intent(inout) :: census
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=*), parameter :: boxes(2:3) = [character(len=50) :: 'x least, y least, x most, y most', &
                                                 'x least, y least, z least, x most, y most, z most']
    type(value_t) :: value
    real(wp) :: box(2*deck%dimension)
    logical :: is_periodic(deck%dimension), is_piece
    integer :: errors

    associate (sample => samples(i), block => samples(i)%block, d => deck%dimension, along => period(:deck%dimension))
      allocate (sample%centre(d, 0), sample%radius(0), sample%templates(0))
      value = deck%value(block, 'box')
      box = value%numbers(:2*d)
      if (any(box(d + 1:) <= box(:d))) then
        call deck%complain(diagnostics, 'the box is empty: it is ['//trim(boxes(d))//']', block, 'box')
        return
      end if
      is_periodic = along > 0 .and. abs(box(:d)) <= 1e-9_wp*along .and. abs(box(d + 1:) - along) <= 1e-9_wp*along
      call sample%random%seed(deck%integer(block, 'seed'))
      errors = diagnostics%count()
      call choose_templates(deck, block, templates, sample%templates, diagnostics)
      if (diagnostics%count() > errors) return
      call sample%sizes%read(deck, block, templates(sample%templates)%reach, templates(sample%templates)%opening, sample%random, &
                             diagnostics)
      if (diagnostics%count() > errors) return
      if (sample%is_rain) then
        call fill_rain(deck, sample, box, is_periodic, diagnostics)
      else if (deck%word(block, 'kind') == 'lattice') then
        is_piece = may_stream .and. .not. sample%sizes%has_sieve .and. any(deck%word(block, 'shape') == ['disk  ', 'sphere'])
        call fill_lattice(deck, box, is_periodic(:d - 1), period(:2), is_piece, sample, census, diagnostics)
        if (is_piece) return
      else
        call fill_random(deck, samples, i, box, period(:2), is_periodic, diagnostics)
      end if
      if (.not. sample%is_rain) call order(sample, box)
      sample%first = int(int(sample%n, i8)*int(deck%rank, i8)/int(deck%ranks, i8)) + 1
      sample%last = int(int(sample%n, i8)*int(deck%rank + 1, i8)/int(deck%ranks, i8))
    end associate
  end subroutine generate_sample

  !> Draw the sizes of a number of grains; where a volume is given, only as many as fill it.
  subroutine draw_sizes(deck, sample, n, volume)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(inout) :: sample
    integer, intent(in) :: n
    real(wp), intent(in), optional :: volume
    real(wp), allocatable :: radius(:), axes(:, :)
    integer :: i, enough, template(n)

    allocate (radius(n), axes(2, n))
    do i = 1, n
      call sample%sizes%draw(sample%random, radius(i), axes(:, i), template(i))
    end do
    enough = n
    if (present(volume)) enough = enough_grains(radius, volume, deck%dimension)
    sample%radius = radius(:enough)
    if (sample%sizes%has_sieve) sample%axes = axes(:, :enough)
    if (size(sample%templates) > 0) sample%template = int(sample%templates(template(:enough)), i4)
  end subroutine draw_sizes

  !> Grains on a lattice: a piece of it, or all.
  subroutine fill_lattice(deck, box, is_periodic, period, is_piece, sample, census, diagnostics)
    type(deck_t), intent(in) :: deck
    real(wp), intent(in) :: box(:), period(2)
    logical, intent(in) :: is_periodic(:), is_piece
    type(sample_t), intent(inout) :: sample
    type(census_t), intent(inout) :: census
    type(diagnostics_t), intent(inout) :: diagnostics
    type(lattice_t) :: lattice
    real(wp) :: pitch, room
    integer :: wanted, i, arrangement
    logical :: is_refused

    associate (block => sample%block)
      pitch = 2*sample%sizes%range(2)*deck%number(block, 'spacing')
      wanted = most
      if (deck%is_given(block, 'count')) then
        wanted = deck%integer(block, 'count')
        call check_room(deck, block, real(wanted, wp), 'count', diagnostics, is_refused)
      else
        associate (room => box(deck%dimension + 1:) - box(:deck%dimension))
          call check_room(deck, block, product(max(1.0_wp, aint(room/pitch))), trim(sample%sizes%key), &
                          diagnostics, is_refused)
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
      room = deck%number(block, 'jitter')*(pitch - 2*sample%sizes%range(2))/2
    end associate
    if (is_piece) then
      if (sample%n > 0) call take_piece(deck, lattice, room, box, period, sample, census)
      return
    end if
    call place_on_lattice(box, pitch, arrangement, is_periodic, wanted, sample%centre)
    call draw_sizes(deck, sample, sample%n)
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

    call take_slice(lattice, sizes_t(sample%sizes%distribution, sample%sizes%range, room), &
                    sample%random, box, period, deck%rank, deck%ranks, slice, census)
    call move_alloc(slice%centre, sample%centre)
    call move_alloc(slice%radius, sample%radius)
    sample%before = slice%before
    sample%first = slice%before + 1
    sample%last = slice%before + size(sample%radius)
  end subroutine take_piece

  !> Grains at random places, inserted or grown, clear of those of the samples before.
  subroutine fill_random(deck, samples, i, box, period, is_periodic, diagnostics)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(inout) :: samples(:)
    integer, intent(in) :: i
    real(wp), intent(in) :: box(:), period(2)
    logical, intent(in) :: is_periodic(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp), allocatable :: there(:, :), their_radii(:)
    logical :: is_refused

    call size_random(deck, samples(i), box, diagnostics, is_refused)
    if (is_refused) return
    associate (sample => samples(i), block => samples(i)%block)
      ! Largest first: late grains are small and still find room.
      call arrange(sample, order_of(-sample%radius))
      call list_neighbours(samples, i, box, period, deck%number(block, 'clearance'), there, their_radii)
      if (deck%word(block, 'kind') == 'grown') then
        call grow_in_box(sample%random, sample%radius, box, deck%number(block, 'clearance'), is_periodic, there, their_radii, &
                         sample%centre, sample%n)
      else
        call insert_at_random(sample%random, sample%radius, box, deck%number(block, 'clearance'), is_periodic, there, &
                              their_radii, sample%centre, sample%n)
      end if
      if (sample%n == size(sample%radius)) return
      call complain_full(deck, block, sample%n, size(sample%radius), size(their_radii), diagnostics)
      sample%n = 0
    end associate
  end subroutine fill_random

  !> Refuse a box in which the grains of a sample find no room.
  subroutine complain_full(deck, block, placed, wanted, others, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block, placed, wanted, others
    type(diagnostics_t), intent(inout) :: diagnostics
    character(len=:), allocatable :: next_to

    next_to = ''
    if (others > 0) next_to = ' next to those of other samples'
    if (deck%word(block, 'kind') == 'grown') then
      call deck%complain(diagnostics, 'the box is too full: '//to_text(wanted)//' grains do not grow to their size'//next_to// &
                         '; a fill of '//merge('0.8', '0.6', deck%dimension == 2)//' is about the most', block, 'box')
    else
      call deck%complain(diagnostics, 'the box is too full: '//to_text(placed)//' of '//to_text(wanted)//' grains found room'// &
                         next_to//'; random insertion rarely passes a fill of '// &
                         trim(merge('0.5 ', '0.35', deck%dimension == 2)), block, 'box')
    end if
  end subroutine complain_full

  !> Grains of a rain: each at a random place of the window, whatever the others are.
  subroutine fill_rain(deck, sample, box, is_periodic, diagnostics)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(inout) :: sample
    real(wp), intent(in) :: box(:)
    logical, intent(in) :: is_periodic(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    real(wp) :: margin(size(box)/2)
    logical :: is_refused
    integer :: i, k, d

    d = size(box)/2
    associate (block => sample%block)
      call check_room(deck, block, deck%number(block, 'count'), 'count', diagnostics, is_refused)
      if (is_refused) return
      call draw_sizes(deck, sample, deck%integer(block, 'count'))
      margin = maxval(sample%radius)
      margin = merge(0.0_wp, margin, is_periodic)
      if (any(box(d + 1:) - box(:d) < 2*margin)) then
        call deck%complain(diagnostics, 'the window is too narrow for grains of a radius of '//to_text(maxval(sample%radius), 4)// &
                           ' m', block, 'box')
        sample%radius = [real(wp) ::]
        return
      end if
      sample%n = size(sample%radius)
      deallocate (sample%centre)
      allocate (sample%centre(d, sample%n))
      do i = 1, sample%n
        do k = 1, d
          associate (margin => merge(sample%radius(i), 0.0_wp, margin(k) > 0))
            sample%centre(k, i) = sample%random%uniform(box(k) + margin, box(d + k) - margin)
          end associate
        end do
      end do
    end associate
  end subroutine fill_rain

  !> Draw the sizes of grains at random places.
  subroutine size_random(deck, sample, box, diagnostics, is_refused)
    type(deck_t), intent(in) :: deck
    type(sample_t), intent(inout) :: sample
    real(wp), intent(in) :: box(:)
    type(diagnostics_t), intent(inout) :: diagnostics
    logical, intent(out) :: is_refused
    real(wp) :: volume, grains

    is_refused = .true.
    associate (block => sample%block, d => deck%dimension)
      if (deck%is_given(block, 'count') .eqv. deck%is_given(block, 'fill')) then
        call deck%complain(diagnostics, 'a [[sample]] that is no lattice needs either "count" or "fill"', block)
        return
      end if
      volume = product(box(d + 1:) - box(:d))
      if (deck%is_given(block, 'count')) then
        grains = real(deck%integer(block, 'count'), wp)
        if (grains*ball_volume(sample%sizes%range(1), d) > volume) then
          call deck%complain(diagnostics, 'the box is too full: '//to_text(nint(grains))//' grains '// &
                             trim(merge('cover', 'fill ', d == 2))//' more than all of it', block, 'box')
          return
        end if
        call check_room(deck, block, grains, 'count', diagnostics, is_refused)
        if (.not. is_refused) call draw_sizes(deck, sample, nint(grains))
      else
        volume = deck%number(block, 'fill')*volume
        grains = sample%sizes%most_grains(volume)
        call check_room(deck, block, grains, 'fill', diagnostics, is_refused)
        if (.not. is_refused) call draw_sizes(deck, sample, int(grains) + 1, volume)
      end if
    end associate
  end subroutine size_random

  !> Grains of the samples before, and their images across the periods, that may reach into a box.
  subroutine list_neighbours(samples, i, box, period, clearance, centre, radius)
    type(sample_t), intent(in) :: samples(:)
    integer, intent(in) :: i
    real(wp), intent(in) :: box(:), period(2), clearance
    real(wp), allocatable, intent(out) :: centre(:, :), radius(:)
    real(wp) :: image(size(box)/2)
    integer :: d, k, grain, turn, n, x, y

    d = size(box)/2
    ! Counted first, then listed.
    do turn = 1, 2
      n = 0
      do k = 1, size(samples)
        if (k == i .or. samples(k)%is_rain .or. samples(k)%moment%s /= samples(i)%moment%s) cycle
        do grain = 1, samples(k)%n
          do y = merge(-1, 0, d == 3 .and. period(2) > 0), merge(1, 0, d == 3 .and. period(2) > 0)
            do x = merge(-1, 0, period(1) > 0), merge(1, 0, period(1) > 0)
              image = samples(k)%centre(:, grain)
              image(1) = image(1) + real(x, wp)*period(1)
              if (d == 3) image(2) = image(2) + real(y, wp)*period(2)
              associate (reach => samples(k)%radius(grain) + clearance)
                if (any(image + reach < box(:d) .or. image - reach > box(d + 1:))) cycle
              end associate
              n = n + 1
              if (turn == 1) cycle
              centre(:, n) = image
              radius(n) = samples(k)%radius(grain)
            end do
          end do
        end do
      end do
      if (turn == 1) allocate (centre(d, n), radius(n))
    end do
  end subroutine list_neighbours

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

  !> How many grains, from the first on, fill an area or a volume.
  pure integer function enough_grains(radii, volume, dimension) result(n)
    real(wp), intent(in) :: radii(:), volume
    integer, intent(in) :: dimension
    real(wp) :: filled

    filled = 0
    do n = 1, size(radii) - 1
      filled = filled + ball_volume(radii(n), dimension)
      if (filled >= volume) return
    end do
  end function enough_grains

  !> Put grains in spatial order.
  subroutine order(sample, box)
    type(sample_t), intent(inout) :: sample
    real(wp), intent(in) :: box(:)
    integer(i4), allocatable :: permutation(:)
    integer :: d

    d = size(box)/2
    permutation = hilbert_order(sample%centre(:, :sample%n), box(:d), maxval(box(d + 1:) - box(:d)))
    sample%centre = sample%centre(:, permutation)
    call arrange(sample, permutation)
  end subroutine order

  !> Put the sizes of grains in another order.
  pure subroutine arrange(sample, permutation)
    type(sample_t), intent(inout) :: sample
    integer(i4), intent(in) :: permutation(:)

    sample%radius = sample%radius(permutation)
    if (allocated(sample%axes)) sample%axes = sample%axes(:, permutation)
    if (allocated(sample%template)) sample%template = sample%template(permutation)
  end subroutine arrange
end module sg_samples_from_deck
