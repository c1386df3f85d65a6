!> Effective radius of two shapes in contact, by which coefficients of rolling and twisting become lengths (doc/theory/laws.md,
!! "Rolling and twisting").
module sg_effective_radius
  use sg_contactors, only: contactors_t
  use sg_kinds, only: wp
  use sg_shape_kinds, only: is_bounding, kind_cylinder, kind_hollow, kind_hollow_cylinder
  implicit none
  private
  public :: effective_radius

contains

  !> Effective radius R_1 R_2/(R_1 + R_2) of two shapes [m]: the radius of a grain on a flat wall, half of it between equal grains,
  !! and r R/(R - r) within a drum. Angular shapes count by the circle or sphere about them, cylinders by their radius.
  pure real(wp) function effective_radius(contactors, pair) result(radius)
    type(contactors_t), intent(in) :: contactors !! contactors of the scene
    integer, intent(in) :: pair(2) !! the two in contact
    real(wp) :: curvature(2), together

    curvature = [curvature_of(contactors, pair(1)), curvature_of(contactors, pair(2))]
    together = sum(curvature)
    ! A grain as large as its drum, and larger ones by rounding.
    if (.not. together > epsilon(1.0_wp)*maxval(abs(curvature))) together = maxval(curvature)
    radius = 0
    if (together > 0) radius = 1/together
  end function effective_radius

  !> Curvature of a shape [1/m]: zero of flat walls, negative of hollow ones.
  pure real(wp) function curvature_of(contactors, c) result(curvature)
    type(contactors_t), intent(in) :: contactors
    integer, intent(in) :: c

    curvature = 0
    associate (kind => contactors%kind(c))
      select case (kind)
      case (kind_hollow)
        curvature = -1/contactors%hollow_radius(contactors%row(c))
      case (kind_hollow_cylinder)
        curvature = -1/contactors%space%hollow_size(2, contactors%row(c))
      case (kind_cylinder)
        curvature = 1/contactors%space%cylinder_size(2, contactors%row(c))
      case default
        if (.not. is_bounding(kind)) curvature = 1/contactors%reach(c)
      end select
    end associate
  end function curvature_of
end module sg_effective_radius
