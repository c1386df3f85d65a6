!> The hull by Qhull [Barber1996], reached through convex_hull_with_qhull.c.
submodule(sg_convex_hull) convex_hull_with_qhull
  use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_funptr, c_int, c_int32_t, c_ptr
  use sg_library, only: find_procedures
  use sg_library_files, only: qhull_file
  implicit none

  !> Qhull's procedures in the order of `struct qhull` in convex_hull_with_qhull.c
  character(len=*), parameter :: names(8) = [character(len=17) :: 'qh_zero', 'qh_new_qhull', 'qh_freeqhull', &
                                             'qh_memfreeshort', 'qh_setsize', 'qh_facet3vertex', 'qh_pointid', 'qh_settempfree']

  interface
    function splitgrain_hull(qhull, n, points, n_faces, first, corner) bind(c, name='splitgrain_hull') result(code)
      import :: c_double, c_funptr, c_int, c_ptr
      type(c_funptr), intent(in) :: qhull(*)
      integer(c_int), value :: n
      real(c_double), intent(in) :: points(3, *)
      integer(c_int), intent(out) :: n_faces
      type(c_ptr), intent(out) :: first, corner
      integer(c_int) :: code
    end function splitgrain_hull
    subroutine splitgrain_hull_free(first, corner) bind(c, name='splitgrain_hull_free')
      import :: c_ptr
      type(c_ptr), value :: first, corner
    end subroutine splitgrain_hull_free
  end interface

contains

  module procedure hull_is_available
  is_available = .true.
  end procedure hull_is_available

  module procedure make_hull
  type(c_funptr) :: qhull(size(names))
  integer(c_int) :: n_faces, code
  type(c_ptr) :: c_first, c_corner
  integer(c_int32_t), pointer :: first(:), corner(:)

  call find_procedures('Qhull, which convex hulls need,', qhull_file, names, qhull, error)
  if (allocated(error)) return
  code = splitgrain_hull(qhull, int(size(points, 2), c_int), points, n_faces, c_first, c_corner)
  if (code == 0) then
    call c_f_pointer(c_first, first, [n_faces + 1])
    call c_f_pointer(c_corner, corner, [first(n_faces + 1) - 1])
    allocate (face_first(n_faces + 1), source=first)
    allocate (face_vertex(size(corner)), source=corner)
  else
    call fail(error, 'no convex hull could be made of '//to_text(size(points, 2))//' points: Qhull ended with code '// &
              to_text(int(code)))
  end if
  call splitgrain_hull_free(c_first, c_corner)
  end procedure make_hull
end submodule convex_hull_with_qhull
