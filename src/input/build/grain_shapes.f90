!> Shapes of the grains of samples and rains: random polygons and polyhedra.
module sg_grain_shapes
  use sg_blocks, only: deck_t
  use sg_error, only: error_t
  use sg_generators, only: draw_polygon
  use sg_kinds, only: wp
  use sg_moments, only: polygon_moments
  use sg_polyhedron, only: polyhedron_t
  use sg_polyhedron_make, only: random_polyhedron
  use sg_sample_sizes, only: draw_axes
  use sg_samples_from_deck, only: sample_t
  implicit none
  private
  public :: grain_polygon, grain_polyhedron

contains

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
    real(wp) :: flatness(2), axes(3)
    integer :: n

    n = drawn_count(deck, sample, 'vertices')
    axes(1) = 1
    if (allocated(sample%axes)) then
      axes(2:) = sample%axes(:, i - sample%before)
    else
      flatness = 0
      if (deck%is_given(sample%block, 'flatness')) flatness = deck%pair(sample%block, 'flatness')
      call draw_axes(sample%random, deck%pair(sample%block, 'elongation'), flatness, axes(2:))
    end if
    call random_polyhedron(n, sample%radius(i - sample%before)*axes, sample%random, shape, error)
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
end module sg_grain_shapes
