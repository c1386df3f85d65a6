!> Sizes of the grains of a sample: radii from a range, or sizes from a sieve curve.
module sg_sample_sizes
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_generators, only: draw_radius
  use sg_kinds, only: wp, pi
  use sg_random, only: random_t
  use sg_sieve, only: named_sieve, sieve_t
  use sg_values, only: value_t
  use sg_words, only: choice_index
  implicit none
  private
  public :: sample_sizes_t, ball_volume, draw_axes

  !> How the grains of a sample are sized
  type :: sample_sizes_t
    !> Least and largest radius of the circle or sphere about a grain [m]
    real(wp) :: range(2) = 0
    !> Spread of radii of a range, one of `size_*`
    integer :: distribution = 1
    !> Are sizes those of a sieve curve?
    logical :: has_sieve = .false.
    !> Key of the deck that gives the sizes
    character(len=6) :: key = 'radius'
    type(sieve_t), private :: sieve
    !> Radius about each template that grains draw from, and smallest opening that it passes [m]; empty where shapes are made
    real(wp), allocatable, private :: reach(:), opening(:)
    !> Are grains as large as their templates?
    logical, private :: is_own = .false.
    !> Dimension of space, and least and largest ratio of the axes of polyhedra
    integer, private :: dimension = 2
    real(wp), private :: elongation(2) = 1
    !> Least and greatest ratio of the middle to the shortest axis; zero where the middle one is drawn between the others
    real(wp), private :: flatness(2) = 0
  contains
    procedure :: read => sizes_read
    procedure :: draw => sizes_draw
    procedure :: most_grains => sizes_most_grains
  end type sample_sizes_t

contains

  !> Read the keys of a sample.
  subroutine sizes_read(self, deck, block, reach, opening, random, diagnostics)
    class(sample_sizes_t), intent(inout) :: self
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: block !! block of the sample
    real(wp), intent(in) :: reach(:) !! radius about each template of the grains [m]; empty where there is none
    real(wp), intent(in) :: opening(:) !! smallest opening that each passes [m]
    type(random_t), intent(inout) :: random !! stream of numbers; a sieve curve takes one of it
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=6), parameter :: keys(3) = ['radius', 'sieve ', 'curve ']
    integer :: i, n

    call check_flatness(deck, block, diagnostics)
    self%dimension = deck%dimension
    self%reach = reach
    self%opening = opening
    n = count([(deck%is_given(block, trim(keys(i))), i=1, 3)])
    self%is_own = n == 0 .and. size(reach) > 0
    if (self%is_own) then
      self%key = 'shape'
      self%range = [minval(reach), maxval(reach)]
      return
    else if (n /= 1) then
      call deck%complain(diagnostics, 'a [[sample]] needs one of the keys "radius", "sieve" and "curve"', block)
      return
    end if
    self%key = keys(findloc([(deck%is_given(block, trim(keys(i))), i=1, 3)], .true., 1))
    self%has_sieve = self%key /= 'radius'
    if (self%has_sieve) then
      call read_sieve(self, deck, block, random, diagnostics)
    else
      self%range = deck%pair(block, 'radius')
      self%distribution = choice_index(deck%word(block, 'distribution'), 'uniform|volume|lognormal|constant')
      if (self%distribution == 4) self%range(2) = self%range(1)
    end if
  end subroutine sizes_read

  !> Refuse flatness that no elongation of the sample reaches.
  subroutine check_flatness(deck, block, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    type(diagnostics_t), intent(inout) :: diagnostics

    if (.not. deck%is_given(block, 'flatness')) return
    if (maxval(deck%pair(block, 'flatness')) > maxval(deck%pair(block, 'elongation'))) &
      call deck%complain(diagnostics, '"flatness" is at most "elongation"', block, 'flatness')
  end subroutine check_flatness

  !> Read a sieve curve.
  subroutine read_sieve(self, deck, block, random, diagnostics)
    type(sample_sizes_t), intent(inout) :: self
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    type(random_t), intent(inout) :: random
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: value
    character(len=:), allocatable :: message
    real(wp), allocatable :: curve(:, :)

    if (self%key == 'curve') then
      curve = named_sieve(deck%word(block, 'curve'))
    else
      value = deck%value(block, 'sieve')
      curve = reshape(value%numbers(:value%n), [2, value%n/2])
    end if
    call self%sieve%begin(curve, deck%dimension, random%uniform(), message)
    if (allocated(message)) then
      call deck%complain(diagnostics, message, block, trim(self%key))
      return
    end if
    if (size(self%reach) > 0) then
      self%range = [curve(1, 1)*minval(self%reach/self%opening), curve(1, size(curve, 2))*maxval(self%reach/self%opening)]
      return
    end if
    if (deck%word(block, 'shape') == 'polyhedron') then
      self%elongation = deck%pair(block, 'elongation')
      if (deck%is_given(block, 'flatness')) self%flatness = deck%pair(block, 'flatness')
    end if
    self%range = [curve(1, 1), curve(1, size(curve, 2))*self%elongation(2)]/2
  end subroutine read_sieve

  !> Draw the template of a grain, the radius of the circle or sphere about it [m], and the second and third half axis over that.
  !!
  !! A polyhedron passes an opening as wide as its middle axis. Of several templates all are equally likely, whatever the size of
  !! the grain: so the masses of the classes of a sieve curve are as given, however full or slender the shapes.
  subroutine sizes_draw(self, random, radius, axes, template)
    class(sample_sizes_t), intent(inout) :: self
    type(random_t), intent(inout) :: random !! stream of numbers
    real(wp), intent(out) :: radius !! [m]
    real(wp), intent(out) :: axes(2) !! drawn with sizes of a sieve curve, else zero
    integer, intent(out) :: template !! its template, 0 where there is none

    axes = 0
    template = min(size(self%reach), 1)
    if (size(self%reach) > 1) template = min(size(self%reach), 1 + int(random%uniform()*real(size(self%reach), wp)))
    if (self%is_own) then
      radius = self%reach(template)
      return
    else if (.not. self%has_sieve) then
      radius = draw_radius(random, self%distribution, self%range, self%dimension)
      return
    end if
    radius = self%sieve%draw()/2
    if (template > 0) then
      radius = 2*radius*self%reach(template)/self%opening(template)
      return
    end if
    if (.not. self%elongation(2) > 1) then
      axes = 1
      return
    end if
    call draw_axes(random, self%elongation, self%flatness, axes)
    radius = radius/axes(1)
  end subroutine sizes_draw

  !> Draw the second and third half axis of an ellipsoid over the first.
  subroutine draw_axes(random, elongation, flatness, axes)
    type(random_t), intent(inout) :: random !! stream of numbers
    real(wp), intent(in) :: elongation(2) !! least and greatest ratio of the longest to the shortest axis
    real(wp), intent(in) :: flatness(2) !! the same of the middle to the shortest; zero to draw the middle between the others
    real(wp), intent(out) :: axes(2) !! middle and shortest half axis over the longest

    axes(2) = 1/random%uniform(elongation(1), elongation(2))
    if (flatness(1) > 0) then
      axes(1) = min(1.0_wp, axes(2)*random%uniform(flatness(1), flatness(2)))
    else
      axes(1) = random%uniform(axes(2), 1.0_wp)
    end if
  end subroutine draw_axes

  !> How many grains may be needed to fill an area or a volume: at least as many as that; of a range, all of the least radius.
  pure real(wp) function sizes_most_grains(self, volume) result(n)
    class(sample_sizes_t), intent(in) :: self
    real(wp), intent(in) :: volume !! [m2] or [m3]

    if (self%has_sieve) then
      ! The sequence strays from the mean by some grains.
      n = 1.1_wp*volume/(ball_volume(0.5_wp, self%dimension)*self%sieve%mean_power()) + 100
    else
      n = volume/ball_volume(self%range(1), self%dimension)
    end if
  end function sizes_most_grains

  !> Area of a circle, or volume of a sphere [m2 or m3].
  pure real(wp) function ball_volume(radius, dimension) result(volume)
    real(wp), intent(in) :: radius !! [m]
    integer, intent(in) :: dimension !! of space

    if (dimension == 2) then
      volume = pi*radius**2
    else
      volume = 4*pi/3*radius**3
    end if
  end function ball_volume
end module sg_sample_sizes
