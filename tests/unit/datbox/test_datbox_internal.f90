!> Laws that keep numbers of their contacts, written into a DATBOX folder and read back.
program test_datbox_internal
  use harness, only: tests_t
  use scenes, only: begin_scene, put_disk, put_wall
  use sg_datbox, only: read_datbox
  use sg_datbox_write, only: write_datbox
  use sg_datbox_write_contacts, only: contacts_at_start
  use sg_error, only: diagnostics_t, error_t
  use sg_internal_values, only: n_internal_of, never
  use sg_kinds, only: wp
  use sg_laws, only: is_cohesive_zone, law_abp, law_elastic_g0, law_expo, law_gap_g0, law_gap_shifted, law_iqs_g0, law_mac, &
                     law_mal, law_th, law_viscoelastic, status_stick
  use sg_scene, only: scene_t, start_contact_t
  implicit none
  integer, parameter :: kinds(10) = [law_iqs_g0, law_gap_g0, law_elastic_g0, law_gap_shifted, law_viscoelastic, &
                                  law_mac, law_mal, law_th, law_abp, law_expo]
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
    allocate (scene%materials(1))
    scene%materials(1)%name = 'stone'
    scene%materials(1)%density = 1000
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
    scene%start_contacts(1)%internal(2:5) = [0.25_wp, 0.75_wp, never, -0.5_wp]
    scene%laws(1)%zone_stiffness = [1e6_wp, 2e6_wp]
    scene%laws(1)%normal_strength = 1000
    scene%laws(1)%tangential_strength = 900
    scene%laws(1)%zone_energy = [10.0_wp, 12.0_wp]
    scene%laws(1)%zone_plateau = [4e-3_wp, 6e-3_wp]
    scene%laws(1)%zone_opening = [0.05_wp, 0.06_wp]
    scene%laws(1)%zone_share = 0.7_wp
    scene%laws(1)%zone_residual = 1e-3_wp
    scene%laws(1)%zone_viscosity = 0.5_wp
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
    if (is_cohesive_zone(scene%laws(1))) call check_zone(scene, again)
    call t%equal(size(again%start_contacts), 2, 'contacts')
    do k = 1, 2
      associate (contact => again%start_contacts(k), first => scene%start_contacts(k))
        call t%check(contact%has_internal .eqv. kind /= law_viscoelastic, 'numbers behind a contact')
        call t%near(contact%force(1), first%force(1), digits, 'the force before them')
        if (n_internal_of(scene%laws(1), 2) > 0) call t%near(contact%internal(1), first%internal(1), digits, 'an internal value')
      end associate
    end do
  end subroutine test_kind

  !> Numbers of a cohesive law, and what it keeps of the first contact.
  subroutine check_zone(scene, again)
    type(scene_t), intent(in) :: scene, again

    associate (a => scene%laws(1), b => again%laws(1))
      call t%near(maxval(abs(b%zone_stiffness/a%zone_stiffness - 1)), 0.0_wp, digits, 'stiffness of a zone')
      call t%near(b%zone_energy(1), a%zone_energy(1), 10*digits, 'energy')
      if (a%kind == law_mac) then
        call t%near(b%zone_viscosity, a%zone_viscosity, digits, 'viscosity of damage')
      else
        call t%near(b%tangential_strength, a%tangential_strength, 1e3_wp*digits, 'strength')
      end if
      if (a%kind == law_th) call t%near(maxval(abs(b%zone_plateau - a%zone_plateau)), 0.0_wp, digits, 'plateau')
      if (a%kind == law_abp) call t%near(maxval(abs(b%zone_opening - a%zone_opening)) + abs(b%zone_share - a%zone_share), &
                                         0.0_wp, digits, 'openings and share')
      if (a%kind == law_expo) call t%near(b%zone_residual, a%zone_residual, digits, 'cut-off')
    end associate
    call t%near(maxval(abs(again%start_contacts(1)%internal(:5) - scene%start_contacts(1)%internal(:5))), 0.0_wp, 1e2_wp*digits, &
                'what a bond keeps')
  end subroutine check_zone
end program test_datbox_internal
