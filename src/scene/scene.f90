!> The scene: bodies, contactors, laws, interactions, gravity, drives, periodicity. No option of a run is here.
module sg_scene
  use sg_bodies, only: bodies_t
  use sg_contactors, only: contactors_t
  use sg_drives, only: drive_t, pressure_t
  use sg_gravity_changes, only: gravity_change_t, gravity_of_step, largest_component
  use sg_internal_values, only: most_internal
  use sg_kinds, only: wp, i1, i4
  use sg_laws, only: law_t
  use sg_links, only: links_t
  use sg_passages, only: entry_t, exit_t
  use sg_periodic_cell, only: periodic_cell_t
  use sg_text, only: append_word, text_t
  implicit none
  private
  public :: scene_t, material_t, see_t, body_group_t, start_contact_t, colour_index, material_index, law_index
  public :: periods_of, set_edges, image_shift, unwrapped, set_gravity, largest_gravity

  !> A bulk material
  type :: material_t
    !> Name by which bodies call it
    character(len=:), allocatable :: name
    !> Mass per volume, in the plane per area and metre of depth [kg/m3]
    real(wp) :: density = 0
  end type material_t

  !> One line of the see tables: which contactors may meet, under which law, from which distance on
  type :: see_t
    !> Kind of shape and colour of the candidate; 0 means any
    integer :: candidate_kind = 0, candidate_colour = 0
    !> Kind of shape and colour of the antagonist; 0 means any
    integer :: antagonist_kind = 0, antagonist_colour = 0
    !> Law, index into the scene's laws
    integer :: law = 0
    !> Contacts exist where the gap is below this [m]
    real(wp) :: alert = 0
    !> Where the motion of a step decides how far it has to be seen, the shortest such distance; the one above is the longest [m]
    real(wp) :: least_alert = huge(1.0_wp)
    !> Bodies between which alone the line holds, whatever other lines there are: index into the scene's groups; 0 for all bodies
    integer :: group = 0
  end type see_t

  !> Bodies on either side of a line of the see tables that holds between named bodies
  type :: body_group_t
    !> Is a body on the one side, and on the other? By its number in the whole scene; of bodies beyond the end neither
    logical, allocatable :: is_one(:), is_other(:)
  end type body_group_t

  !> A contact known before the first step: its impulse starts the solver
  type :: start_contact_t
    !> Contactors, candidate and antagonist
    integer :: contactor(2) = 0
    !> Where it touches [m]: distinguishes two points of one pair
    real(wp) :: point(3) = 0
    !> Mean force over the last step [N]: normal and tangential; in space on the candidate, in the world's axes
    real(wp) :: force(3) = 0
    !> What it did in the last step
    integer(i1) :: status = 0
    !> Is the force a vector in the world's axes, as in space?
    logical :: is_vector = .false.
    !> Internal values of its law, and whether they were read
    real(wp) :: internal(most_internal) = 0
    logical :: has_internal = .false.
  end type start_contact_t

  !> A scene
  type :: scene_t
    !> Dimension of space
    integer :: dimension = 2
    !> Rigid bodies
    type(bodies_t) :: bodies
    !> Shapes through which they touch
    type(contactors_t) :: contactors
    !> Bulk materials
    type(material_t), allocatable :: materials(:)
    !> Contact laws
    type(law_t), allocatable :: laws(:)
    !> Do laws of any stage of the run resist rolling or twisting, so that all stages have moments at contacts?
    logical :: bears_moments = .false.
    !> Names of the colours
    type(text_t), allocatable :: colours(:)
    !> Interactions; the first that fits a pair counts
    type(see_t), allocatable :: sees(:)
    !> Named bodies of lines of the see tables, in their order; unallocated where no line names bodies
    type(body_group_t), allocatable :: groups(:)
    !> Links between points
    type(links_t) :: links
    !> Imposed velocities and forces
    type(drive_t), allocatable :: drives(:)
    !> Pressed walls
    type(pressure_t), allocatable :: pressures(:)
    !> Contacts known at the start
    type(start_contact_t), allocatable :: start_contacts(:)
    !> Bodies that come after the start, and boxes out of which bodies leave; unallocated where there are none
    type(entry_t), allocatable :: entries(:)
    type(exit_t), allocatable :: exits(:)
    !> Names of bodies, shape (bodies); only where the deck names some, and dropped where the scene is split
    type(text_t), allocatable :: names(:)
    !> Gravity [m/s2], that of the last step where it changes; in the plane the third component is zero
    real(wp) :: gravity(3) = 0
    !> Components of gravity that change with time, and gravity where none of these acts [m/s2]; unallocated where none changes
    type(gravity_change_t), allocatable :: gravity_changes(:)
    real(wp) :: steady_gravity(3) = 0
    !> Length of the period in x, and in space in y [m]; zero when not periodic. With a periodic cell those of all axes in the
    !! `middle` configuration of the bodies
    real(wp) :: period = 0, period_y = 0, period_z = 0
    !> The periodic cell, where there is one
    type(periodic_cell_t) :: cell
    !> Share by which contact points of a face are moved to its middle, for two polygons and two polyhedra
    real(wp) :: shrink = 0
    !> Motion of two polygons or polyhedra against each other, over the reach of the smaller one, up to which their contacts are
    !! kept from step to step (sg_kept_contacts); 0 for never
    real(wp) :: kept_motion = 0
    !> Time [s] and step number at the start
    real(wp) :: start_time = 0
    integer(i4) :: start_step = 0
  end type scene_t

contains

  !> Set gravity to that of a step, where it changes with time.
  pure subroutine set_gravity(scene, time, h, theta)
    type(scene_t), intent(inout) :: scene !! scene with its gravity
    real(wp), intent(in) :: time !! beginning of the step [s]
    real(wp), intent(in) :: h !! time step [s]
    real(wp), intent(in) :: theta !! weight of the end of the step

    if (allocated(scene%gravity_changes)) &
      scene%gravity = gravity_of_step(scene%steady_gravity, scene%gravity_changes, time, h, theta)
  end subroutine set_gravity

  !> Size of gravity [m/s2]; where it changes with time, a bound at all times.
  pure real(wp) function largest_gravity(scene) result(largest)
    type(scene_t), intent(in) :: scene !! scene with its gravity
    integer :: c

    if (allocated(scene%gravity_changes)) then
      largest = norm2([(largest_component(scene%steady_gravity, scene%gravity_changes, c), c=1, 3)])
    else
      largest = norm2(scene%gravity)
    end if
  end function largest_gravity

  !> Periods along x, y, z [m]; zero where there is none.
  pure function periods_of(scene) result(period)
    type(scene_t), intent(in) :: scene !! scene with its periods
    real(wp) :: period(3)

    period = [scene%period, scene%period_y, scene%period_z]
  end function periods_of

  !> Set the edges of the `middle` configuration of a periodic cell.
  pure subroutine set_edges(scene, edge)
    type(scene_t), intent(inout) :: scene !! scene with a cell
    real(wp), intent(in) :: edge(4) !! lengths along x, y, z, and tilt [m]

    scene%cell%middle = edge
    scene%period = edge(1)
    scene%period_y = edge(2)
    if (scene%dimension == 3) scene%period_z = edge(3)
  end subroutine set_edges

  !> Way from a place to one of its images in the `middle` configuration [m].
  pure function image_shift(scene, image) result(shift)
    type(scene_t), intent(in) :: scene !! scene with its periods
    integer, intent(in) :: image(3) !! periods along x, y, z
    real(wp) :: shift(3)

    shift = [scene%period*real(image(1), wp), scene%period_y*real(image(2), wp), scene%period_z*real(image(3), wp)]
    if (scene%cell%is_on) shift(1) = shift(1) + scene%cell%middle(4)*real(image(2), wp)
  end function image_shift

  !> Place of a body [m], not folded into the period; in the plane the third component is zero.
  pure function unwrapped(scene, bodies, body) result(place)
    type(scene_t), intent(in) :: scene !! scene with its periods
    type(bodies_t), intent(in) :: bodies !! its bodies, or some of them
    integer, intent(in) :: body !! index of the body
    real(wp) :: place(3), edge(4)
    integer :: crossed(3)

    crossed = 0
    crossed(1) = bodies%crossings(body)
    if (allocated(bodies%crossings_y)) crossed(2) = bodies%crossings_y(body)
    if (allocated(bodies%crossings_z)) crossed(3) = bodies%crossings_z(body)
    edge = [scene%period, scene%period_y, scene%period_z, 0.0_wp]
    if (scene%cell%is_on) edge = scene%cell%now
    place = 0
    place(:bodies%dimension) = bodies%position(:, body)
    place = place + edge(:3)*real(crossed, wp)
    if (scene%cell%is_on) place(1) = place(1) + edge(4)*real(crossed(2), wp)
  end function unwrapped

  !> Index of a colour, added when it is new.
  subroutine colour_index(scene, name, colour)
    type(scene_t), intent(inout) :: scene !! scene that lists the colours
    character(len=*), intent(in) :: name !! name to look for
    integer, intent(out) :: colour !! its index

    if (.not. allocated(scene%colours)) allocate (scene%colours(0))
    do colour = 1, size(scene%colours)
      if (scene%colours(colour)%s == name) return
    end do
    call append_word(scene%colours, name)
    colour = size(scene%colours)
  end subroutine colour_index

  !> Index of a material by name; 0 when there is none.
  pure integer function material_index(scene, name) result(material)
    type(scene_t), intent(in) :: scene !! scene that lists the materials
    character(len=*), intent(in) :: name !! name to look for

    if (allocated(scene%materials)) then
      do material = 1, size(scene%materials)
        if (scene%materials(material)%name == name) return
      end do
    end if
    material = 0
  end function material_index

  !> Index of a law by name; 0 when there is none.
  pure integer function law_index(scene, name) result(law)
    type(scene_t), intent(in) :: scene !! scene that lists the laws
    character(len=*), intent(in) :: name !! name to look for

    if (allocated(scene%laws)) then
      do law = 1, size(scene%laws)
        if (scene%laws(law)%name == name) return
      end do
    end if
    law = 0
  end function law_index
end module sg_scene
