!> Links written into a DATBOX folder and read back: laws, ends, lengths at rest, forces and what is broken, in the plane and in
!! space, for points that stand behind all other contactors.
program test_datbox_links_written
  use harness, only: tests_t
  use link_scenes, only: begin_links, link, put_mass
  use sg_contactors, only: add_disk, add_point
  use sg_datbox, only: read_datbox
  use sg_datbox_write, only: write_datbox
  use sg_datbox_write_contacts, only: contacts_at_start
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp
  use sg_laws, only: law_bond, law_rigid_wire, law_rod, law_t, law_wire, status_broken, status_stick
  use sg_scene, only: scene_t, start_contact_t
  use sg_space_contactors, only: add_sphere
  implicit none
  ! The format holds eight digits of numbers of order one.
  real(wp), parameter :: digits = 1e-7_wp
  type(tests_t) :: t
  integer :: dimension

  do dimension = 2, 3
    call test_law(dimension, law_t(kind=law_rod, axial_stiffness=3e3_wp, prestrain=-0.1_wp), .false.)
    call test_law(dimension, law_t(kind=law_rod, axial_stiffness=3e3_wp, axial_damping=7.0_wp), .true.)
    call test_law(dimension, law_t(kind=law_wire, axial_stiffness=3e3_wp), .true.)
    call test_law(dimension, law_t(kind=law_wire, axial_stiffness=3e3_wp, breaking_force=9.0_wp), .true.)
    call test_law(dimension, law_t(kind=law_rigid_wire), .true.)
    call test_law(dimension, law_t(kind=law_bond, young=2e9_wp, poisson=0.25_wp, normal_strength=1e6_wp, &
                                   tangential_strength=2e6_wp), .true.)
  end do
  call t%finish()

contains

  !> Three balls and two links, one of them to a point off the centre.
  subroutine make(dimension, law, is_known, scene)
    integer, intent(in) :: dimension
    type(law_t), intent(in) :: law
    logical, intent(in) :: is_known
    type(scene_t), intent(out) :: scene
    real(wp) :: place(3), shift(3)
    integer :: b

    call begin_links(scene, 3, dimension, law)
    allocate (scene%materials(1))
    scene%materials(1)%name = 'stone'
    scene%materials(1)%density = 1000
    scene%bodies%material = 1
    do b = 1, 3
      place = [real(b, wp), 0.5_wp*real(b, wp), 0.25_wp]
      call put_mass(scene, b, 10.0_wp, place(:dimension))
      if (dimension == 2) scene%bodies%inertia(b) = 0.1_wp
      if (dimension == 3) scene%bodies%principal(:, b) = 0.04_wp
      scene%bodies%inverse_mass(dimension + 1:, b) = merge(10.0_wp, 25.0_wp, dimension == 2)
      if (dimension == 2) call add_disk(scene%contactors, b, 1, 0.1_wp, [0.0_wp, 0.0_wp])
      if (dimension == 3) call add_sphere(scene%contactors, b, 1, (0.03_wp/(4*acos(-1.0_wp)))**(1.0_wp/3), [0.0_wp, 0.0_wp, 0.0_wp])
    end do
    shift = [0.05_wp, 0.02_wp, 0.0_wp]
    call add_point(scene%contactors, 1, 1, shift(:dimension))
    call link(scene, 1, 3, 1.05_wp, [0.01_wp, 0.2_wp])
    call link(scene, 5, 7, 1.25_wp, [0.02_wp, 0.3_wp])
    if (.not. is_known) return
    scene%start_contacts = [start_contact_t(contactor=[7, 5], force=[4.0_wp, 0.0_wp, 0.0_wp], status=status_stick, &
                                            is_vector=dimension == 3), &
                            start_contact_t(contactor=[3, 1], status=status_broken, is_vector=dimension == 3)]
    scene%start_contacts%internal(1) = [1.5_wp, 1.25_wp]
  end subroutine make

  !> What is written comes back.
  subroutine test_law(dimension, law, is_known)
    integer, intent(in) :: dimension
    type(law_t), intent(in) :: law
    logical, intent(in) :: is_known
    type(scene_t) :: scene, again
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error
    integer :: known

    call make(dimension, law, is_known, scene)
    call write_datbox('datbox_links_written', scene, contacts_at_start(scene), 0.0_wp, 0, error)
    call t%check(.not. allocated(error), 'writing')
    if (allocated(error)) print '(a)', error%message
    if (allocated(error)) return
    call read_datbox('datbox_links_written', again, diagnostics)
    call t%equal(diagnostics%count(), 0, 'reading')
    if (diagnostics%count() > 0) print '(a)', diagnostics%errors(1)%report()
    if (diagnostics%count() > 0) return
    call t%equal(again%laws(1)%kind, law%kind, 'kind of law')
    call t%near(maxval(abs([again%laws(1)%axial_stiffness/3e3_wp - law%axial_stiffness/3e3_wp, &
                            again%laws(1)%axial_damping - law%axial_damping, again%laws(1)%prestrain - law%prestrain, &
                            again%laws(1)%breaking_force - law%breaking_force, again%laws(1)%young/1e9_wp - law%young/1e9_wp])), &
                0.0_wp, digits, 'numbers of the law')
    call t%equal(again%links%n, 2, 'links')
    if (again%links%n /= 2) return
    ! Body by body: a point, a ball and the point off the centre, then a point and a ball, twice.
    call t%check(all(again%links%number(:, :2) == reshape([4, 1, 6, 3], [2, 2])), 'ends')
    call t%near(maxval(abs(again%links%length(:2) - scene%links%length(:2))), 0.0_wp, digits, 'lengths at rest')
    if (law%kind == law_bond) call t%near(maxval(abs(again%links%area(:2) - scene%links%area(:2))), 0.0_wp, digits, 'sections')
    known = size(again%start_contacts)
    call t%equal(known, 2, 'contacts known')
    if (.not. is_known .or. known < 2) return
    call t%near(again%start_contacts(1)%force(1), 4.0_wp, 4*digits, 'force')
    if (law%breaking_force > 0 .or. law%kind == law_bond) &
      call t%equal(int(again%start_contacts(2)%status), int(status_broken), 'what is broken')
    if (law%kind == law_bond) call t%near(again%start_contacts(1)%internal(1), 1.5_wp, 2*digits, 'first length of a bond')
  end subroutine test_law
end program test_datbox_links_written
