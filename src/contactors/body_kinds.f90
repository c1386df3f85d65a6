!> Kind of a body: the kind of its only shape, or clump where it has several; walls of one bounding shape have none.
module sg_body_kinds
  use sg_contactors, only: contactors_t
  use sg_kinds, only: i4
  use sg_shape_kinds, only: is_bounding, kind_names, kind_point, n_kinds
  implicit none
  private
  public :: body_kinds, body_kind_name, n_body_kinds

  !> Number of the kind of bodies with several shapes, after those of shapes; number of kinds of bodies
  integer, parameter :: kind_clump = n_kinds + 1, n_body_kinds = n_kinds + 1

contains

  !> Kind of each body; 0 where it has no shape, or one bounding shape alone (segment, plane, hollow). Points of links do not count.
  pure function body_kinds(contactors, n_bodies) result(kinds)
    type(contactors_t), intent(in) :: contactors !! shapes of the bodies
    integer, intent(in) :: n_bodies !! number of bodies
    integer(i4) :: kinds(n_bodies)
    integer :: c

    kinds = 0
    do c = 1, contactors%n
      if (contactors%kind(c) == kind_point) cycle
      associate (kind => kinds(contactors%body(c)))
        kind = merge(contactors%kind(c), int(kind_clump, i4), kind == 0)
      end associate
    end do
    do c = 1, n_bodies
      if (kinds(c) == 0 .or. kinds(c) == kind_clump) cycle
      if (is_bounding(kinds(c))) kinds(c) = 0
    end do
  end function body_kinds

  !> Word of a kind of bodies in names of columns.
  pure function body_kind_name(kind) result(name)
    integer, intent(in) :: kind !! kind of a body
    character(len=:), allocatable :: name

    name = 'clump'
    if (kind <= n_kinds) name = trim(kind_names(kind))
  end function body_kind_name
end module sg_body_kinds
