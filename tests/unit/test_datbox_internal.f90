!> Laws that keep numbers of their contacts, written into a DATBOX folder and read back.
program test_datbox_internal
  use harness, only: tests_t
  use scenes, only: begin_scene, put_disk, put_wall
  use sg_datbox, only: read_datbox
  use sg_datbox_write, only: write_datbox
  use sg_datbox_write_contacts, only: contacts_at_start
  use sg_error, only: diagnostics_t, error_t
  use sg_internal_values, only: n_internal_of
  use sg_kinds, only: wp
  use sg_laws, only: law_elastic_g0, law_gap_g0, law_gap_shifted, law_iqs_g0, law_viscoelastic, status_stick
  use sg_scene, only: material_t, scene_t, start_contact_t
  implicit none
  integer, parameter :: kinds(5) = [law_iqs_g0, law_gap_g0, law_elastic_g0, law_gap_shifted, law_viscoelastic]
  ! The format holds eight digits of numbers of order one.
  real(wp), parameter :: digits = 1e-7_wp
  type(tests_t) :: t
  integer :: i

  do i = 1, size(kinds)
    call test_kind(kinds(i))
  end do
  call t%finish()

contains

  !> Two disks on a wall under one law.
  subroutine make(kind, scene)
    integer, intent(in) :: kind
    type(scene_t), intent(out) :: scene

    call begin_scene(scene, 3, 0.3_wp, 0.05_wp)
    scene%materials = [material_t('stone', 1000.0_wp)]
    scene%bodies%material = 1
    call put_disk(scene, 1, 0.1_wp, [0.0_wp, 0.1_wp])
    call put_disk(scene, 2, 0.1_wp, [0.2_wp, 0.1_wp])
    call put_wall(scene, 3, 3.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    scene%laws(1)%kind = kind
    scene%laws(1)%stiffness = 5
    scene%laws(1)%viscosity = 0.7_wp
    scene%laws(1)%gap_shift = -0.2_wp
    scene%start_contacts = [start_contact_t([1, 2], [0.1_wp, 0.1_wp, 0.0_wp], [2.0_wp, 1.0_wp, 0.0_wp], status_stick), &
                            start_contact_t([2, 3], [0.2_wp, 0.0_wp, 0.0_wp], [3.0_wp, 0.5_wp, 0.0_wp], status_stick)]
    scene%start_contacts(1)%internal(1) = 0.125_wp
    scene%start_contacts(2)%internal(1) = -0.5_wp
  end subroutine make

  !> What is written of a law and of its contacts comes back.
  subroutine test_kind(kind)
    integer, intent(in) :: kind
    type(scene_t) :: scene, again
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error
    integer :: k

    call make(kind, scene)
    call write_datbox('datbox_internal', scene, contacts_at_start(scene), 0.0_wp, 0, error)
    call t%check(.not. allocated(error), 'writing')
    if (allocated(error)) return
    call read_datbox('datbox_internal', again, diagnostics)
    call t%equal(diagnostics%count(), 0, 'reading')
    if (diagnostics%count() > 0) call diagnostics%print(6)
    if (diagnostics%count() > 0) return
    associate (a => scene%laws(1), b => again%laws(1))
      call t%equal(b%kind, a%kind, 'kind of law')
      call t%near(b%static_friction, 0.3_wp, digits, 'friction')
      if (any(kind == [law_elastic_g0, law_viscoelastic])) call t%near(b%stiffness, 5.0_wp, digits, 'stiffness')
      if (kind == law_viscoelastic) call t%near(b%viscosity, 0.7_wp, digits, 'viscosity')
      if (kind == law_gap_shifted) call t%near(b%gap_shift, -0.2_wp, digits, 'shift of the gap')
    end associate
    call t%equal(size(again%start_contacts), 2, 'contacts')
    do k = 1, 2
      associate (contact => again%start_contacts(k), first => scene%start_contacts(k))
        call t%check(contact%has_internal .eqv. kind /= law_viscoelastic, 'numbers behind a contact')
        call t%near(contact%force(1), first%force(1), digits, 'the force before them')
        if (n_internal_of(scene%laws(1), 2) > 0) call t%near(contact%internal(1), first%internal(1), digits, 'an internal value')
      end associate
    end do
  end subroutine test_kind
end program test_datbox_internal
