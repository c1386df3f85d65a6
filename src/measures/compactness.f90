!> How much of their box the grains fill.
!!
!! The box of the grains is the smallest upright one that holds their shapes at the detection configuration; where the
!! scene is periodic it is as wide as the period.
module sg_compactness
  use sg_contactors, only: contactors_t, kind_cylinder, kind_hollow_cylinder, kind_plane, kind_polygon, kind_polyhedron, &
                           kind_segment
  use sg_grains, only: grains_of, grains_t
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_tally, only: pass_columns, pass_largest, ratio, tally_t
  implicit none
  private
  public :: measure_compactness, box_of, area_of_box

contains

  !> Share of the box of the grains that they fill.
  pure subroutine measure_compactness(scene, tally)
    type(scene_t), intent(in) :: scene !! scene with its contactors placed
    type(tally_t), intent(inout) :: tally !! tally of the measure
    type(grains_t) :: grains

    if (tally%pass == pass_largest) then
      associate (box => box_of_grains(scene))
        call tally%largest%put('box', [-box(:, 1), box(:, 2)])
      end associate
    else if (tally%pass == pass_columns) then
      grains = grains_of(tally)
      call tally%add('compactness', ratio(grains%area, area_of_box(scene, tally)))
    end if
  end subroutine measure_compactness

  !> Lowest and highest coordinates of the grains of this rank [m]; the lowest above the highest without any.
  pure function box_of_grains(scene) result(box)
    type(scene_t), intent(in) :: scene
    real(wp) :: box(scene%dimension, 2), corner(scene%dimension, 2)
    integer :: c

    box(:, 1) = huge(box)
    box(:, 2) = -huge(box)
    do c = 1, scene%contactors%n
      if (scene%contactors%body(c) > scene%bodies%n_own) cycle
      if (.not. scene%bodies%is_grain(scene%contactors%body(c))) cycle
      associate (centre => scene%contactors%centre(:, c), reach => scene%contactors%reach(c))
        ! Nearly all grains: nothing of them stands out.
        if (all(centre - reach >= box(:, 1)) .and. all(centre + reach <= box(:, 2))) cycle
      end associate
      if (scene%dimension == 3) then
        corner = extent_in_space(scene%contactors, c)
      else
        corner = extent(scene%contactors, c)
      end if
      box(:, 1) = min(box(:, 1), corner(:, 1))
      box(:, 2) = max(box(:, 2), corner(:, 2))
    end do
  end function box_of_grains

  !> Lowest and highest coordinates of all grains [m].
  pure function box_of(dimension, tally) result(box)
    integer, intent(in) :: dimension !! of space
    type(tally_t), intent(in) :: tally !! tally of the measure, its largest values combined
    real(wp) :: box(dimension, 2)

    box = reshape(tally%largest%get('box', 2*dimension), shape(box))
    box(:, 1) = -box(:, 1)
  end function box_of

  !> Area of the box of all grains [m2], in space its volume [m3], as wide as the period where there is one; zero for an empty one.
  pure real(wp) function area_of_box(scene, tally) result(area)
    type(scene_t), intent(in) :: scene !! scene with its periods
    type(tally_t), intent(in) :: tally !! tally of the measure, its largest values combined
    real(wp) :: box(scene%dimension, 2), high(scene%dimension)

    area = 0
    box = box_of(scene%dimension, tally)
    if (any(box(:, 1) > box(:, 2))) return
    high = box(:, 2)
    if (scene%period > 0) high(1) = box(1, 1) + scene%period
    if (scene%period_y > 0) high(2) = box(2, 1) + scene%period_y
    if (scene%period_z > 0) high(3) = box(3, 1) + scene%period_z
    area = product(high - box(:, 1))
  end function area_of_box

  !> Lowest and highest coordinates of a shape in the plane [m].
  pure function extent(contactors, c) result(corner)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp) :: corner(2, 2), reach(2)
    integer :: row, i

    row = contactors%row(c)
    reach = contactors%reach(c)
    select case (contactors%kind(c))
    case (kind_polygon)
      corner(:, 1) = contactors%polygon_world(:, contactors%polygon_first(row))
      corner(:, 2) = corner(:, 1)
      do i = contactors%polygon_first(row) + 1, contactors%polygon_first(row + 1) - 1
        corner(:, 1) = min(corner(:, 1), contactors%polygon_world(:, i))
        corner(:, 2) = max(corner(:, 2), contactors%polygon_world(:, i))
      end do
      return
    case (kind_segment)
      reach = contactors%segment_size(1, row)*abs(contactors%segment_axis(:, row)) + contactors%segment_size(2, row)
    end select
    corner(:, 1) = contactors%centre(:, c) - reach
    corner(:, 2) = contactors%centre(:, c) + reach
  end function extent

  !> Lowest and highest coordinates of a shape in space [m]; a hollow cylinder is as thin as its surface.
  pure function extent_in_space(contactors, c) result(corner)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c
    real(wp) :: corner(3, 2), reach(3)
    integer :: row, i

    row = contactors%row(c)
    reach = contactors%reach(c)
    associate (space => contactors%space)
      select case (contactors%kind(c))
      case (kind_polyhedron)
        associate (vertex => space%polyhedra(row)%world_vertex)
          corner(:, 1) = vertex(:, 1)
          corner(:, 2) = vertex(:, 1)
          do i = 2, size(vertex, 2)
            corner(:, 1) = min(corner(:, 1), vertex(:, i))
            corner(:, 2) = max(corner(:, 2), vertex(:, i))
          end do
        end associate
        return
      case (kind_plane)
        reach = space%plane_half(:, row)
        if (space%plane_rim(row) > 0) reach(3) = 0
        reach = matmul(abs(reshape(space%plane_world(:, row), [3, 3])), reach) + space%plane_rim(row)
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
