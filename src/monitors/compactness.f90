!> How much of their box the grains fill.
!!
!! The box of the grains is the smallest upright one that holds their shapes at the detection configuration; in a
!! periodic scene its width is the period.
module sg_compactness
  use sg_contactors, only: contactors_t, kind_polygon, kind_wall
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  implicit none
  private
  public :: box_area

contains

  !> Area of the box of the grains [m2]; zero without grains.
  pure real(wp) function box_area(scene) result(area)
    type(scene_t), intent(in) :: scene !! scene with its contactors placed
    real(wp) :: low(2), high(2), corner(2, 2)
    integer :: c
    logical :: is_empty

    is_empty = .true.
    low = huge(low)
    high = -huge(high)
    do c = 1, scene%contactors%n
      if (.not. scene%bodies%is_grain(scene%contactors%body(c))) cycle
      corner = extent(scene%contactors, c)
      low = min(low, corner(:, 1))
      high = max(high, corner(:, 2))
      is_empty = .false.
    end do
    area = 0
    if (is_empty) return
    if (scene%period > 0) high(1) = low(1) + scene%period
    area = product(high - low)
  end function box_area

  !> Lowest and highest coordinates of a shape [m].
  pure function extent(contactors, c) result(corner)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp) :: corner(2, 2), reach(2)
    integer :: row

    row = contactors%row(c)
    reach = contactors%reach(c)
    select case (contactors%kind(c))
    case (kind_polygon)
      associate (vertex => contactors%polygon_world(:, contactors%polygon_first(row):contactors%polygon_first(row + 1) - 1))
        corner(:, 1) = minval(vertex, 2)
        corner(:, 2) = maxval(vertex, 2)
      end associate
      return
    case (kind_wall)
      reach = contactors%wall_size(1, row)*abs(contactors%wall_axis(:, row)) + contactors%wall_size(2, row)
    end select
    corner(:, 1) = contactors%centre(:, c) - reach
    corner(:, 2) = contactors%centre(:, c) + reach
  end function extent
end module sg_compactness
