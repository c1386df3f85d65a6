!> The table of shapes: what holds for each kind, whatever its size.
module sg_shape_kinds
  implicit none
  private
  public :: kind_disk, kind_segment, kind_hollow, kind_polygon, kind_point, n_kinds
  public :: kind_sphere, kind_plane, kind_cylinder, kind_hollow_cylinder, kind_polyhedron
  public :: shape_kind_t, shape_kinds, kind_names, is_round, is_bounding, is_hollow

  !> Number of each kind, as contactors, pictures and checkpoints hold it: its row in the table
  integer, parameter :: kind_disk = 1, kind_segment = 2, kind_hollow = 3, kind_polygon = 4, kind_sphere = 5, kind_plane = 6, &
                        kind_cylinder = 7, kind_hollow_cylinder = 8, kind_polyhedron = 9, kind_point = 10
  !> Number of kinds
  integer, parameter :: n_kinds = 10

  !> What holds for a kind of shape
  type :: shape_kind_t
    !> Its word in decks
    character(len=15) :: name
    !> Dimension of space; 0 where it is in both
    integer :: dimension
    !> Has it no orientation?
    logical :: is_round
    !> Does it bound what others do? It may be far larger than grains, and the broad phase has a bound of its own for it
    logical :: is_bounding
    !> Is it touched from inside?
    logical :: is_hollow
    !> LMGC90's name, and its letters in the names of pairs; of a point the third letter of the name is the dimension
    character(len=5) :: datbox_name
    character(len=2) :: datbox_letters
  end type shape_kind_t

  !> All kinds. A segment is rounded, a plane is a box, thin as a rule, a cylinder has round ends, a hollow cylinder open ones, a
  !! polygon and a polyhedron are convex; a point is the end of links, without extent or table, and touches nothing
  type(shape_kind_t), parameter :: shape_kinds(n_kinds) = [ &
    !            name              dimension round  bounding hollow  LMGC90
    shape_kind_t('disk', 2, .true., .false., .false., 'DISKx', 'DK'), &
    shape_kind_t('segment', 2, .false., .true., .false., 'JONCx', 'JC'), &
    shape_kind_t('hollow disk', 2, .true., .true., .true., 'xKSID', 'KD'), &
    shape_kind_t('polygon', 2, .false., .false., .false., 'POLYG', 'PL'), &
    shape_kind_t('sphere', 3, .true., .false., .false., 'SPHER', 'SP'), &
    shape_kind_t('plane', 3, .false., .true., .false., 'PLANx', 'PL'), &
    shape_kind_t('cylinder', 3, .false., .false., .false., 'CYLND', 'CD'), &
    shape_kind_t('hollow cylinder', 3, .false., .true., .true., 'DNLYC', 'DC'), &
    shape_kind_t('polyhedron', 3, .false., .false., .false., 'POLYR', 'PR'), &
    shape_kind_t('point', 0, .true., .false., .false., 'PTxDx', 'PT')]

  !> Columns of the table
  character(len=15), parameter :: kind_names(n_kinds) = shape_kinds%name
  logical, parameter :: is_round(n_kinds) = shape_kinds%is_round
  logical, parameter :: is_bounding(n_kinds) = shape_kinds%is_bounding
  logical, parameter :: is_hollow(n_kinds) = shape_kinds%is_hollow
end module sg_shape_kinds
