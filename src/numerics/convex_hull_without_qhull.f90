!> A build without convex hulls: shapes given by points alone are refused.
submodule(sg_convex_hull) convex_hull_without_qhull
  implicit none

contains

  module procedure hull_is_available
  is_available = .false.
  end procedure hull_is_available

  module procedure make_hull
  call fail(error, 'this program was built without Qhull, which convex hulls need; '// &
            'polyhedra given with their faces do without')
  end procedure make_hull
end submodule convex_hull_without_qhull
