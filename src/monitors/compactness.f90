!> How much of their box the grains fill.
!!
!! The box of the grains is the smallest upright one that holds their shapes at the detection configuration; where the
!! scene is periodic it is as wide as the period.
module sg_compactness
  use sg_contactors, only: contactors_t, kind_cylinder, kind_hollow_cylinder, kind_plane, kind_polygon, kind_polyhedron, kind_wall
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  implicit none
  private
  public :: box_area

contains

  !> Area of the box of the grains [m2], in space its volume [m3]; zero without grains.
  pure real(wp) function box_area(scene) result(area)
    type(scene_t), intent(in) :: scene !! scene with its contactors placed
    real(wp) :: low(scene%dimension), high(scene%dimension), corner(scene%dimension, 2)
    integer :: c
    logical :: is_empty

    is_empty = .true.
    low = huge(low)
    high = -huge(high)
    do c = 1, scene%contactors%n
      if (.not. scene%bodies%is_grain(scene%contactors%body(c))) cycle
      if (scene%dimension == 3) then
        corner = extent_in_space(scene%contactors, c)
      else
        corner = extent(scene%contactors, c)
      end if
      low = min(low, corner(:, 1))
      high = max(high, corner(:, 2))
      is_empty = .false.
    end do
    area = 0
    if (is_empty) return
    if (scene%period > 0) high(1) = low(1) + scene%period
    if (scene%period_y > 0) high(2) = low(2) + scene%period_y
    area = product(high - low)
  end function box_area

  !> Lowest and highest coordinates of a shape in the plane [m].
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

  !> Lowest and highest coordinates of a shape in space [m]; a hollow cylinder is as thin as its surface.
  pure function extent_in_space(contactors, c) result(corner)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp) :: corner(3, 2), reach(3)
    integer :: row

    row = contactors%row(c)
    reach = contactors%reach(c)
    associate (space => contactors%space)
      select case (contactors%kind(c))
      case (kind_polyhedron)
        corner(:, 1) = minval(space%polyhedra(row)%world_vertex, 2)
        corner(:, 2) = maxval(space%polyhedra(row)%world_vertex, 2)
        return
      case (kind_plane)
        reach = matmul(abs(reshape(space%plane_world(:, row), [3, 3])), space%plane_half(:, row))
      case (kind_cylinder)
        reach = space%cylinder_size(1, row)*abs(space%cylinder_world(:, row)) + space%cylinder_size(2, row)
      case (kind_hollow_cylinder)
        associate (axis => space%hollow_world(:, row))
          reach = space%hollow_size(1, row)*abs(axis) + space%hollow_size(2, row)*sqrt(max(0.0_wp, 1 - axis**2))
        end associate
      end select
    end associate
    corner(:, 1) = contactors%centre(:, c) - reach
    corner(:, 2) = contactors%centre(:, c) + reach
  end function extent_in_space
end module sg_compactness
