!> LMGC90's own decks as DATBOX folders: counts, masses, and what is written read back.
program test_datbox_decks
  use harness, only: tests_t
  use sg_datbox, only: read_datbox
  use sg_datbox_write, only: write_datbox
  use sg_datbox_write_contacts, only: contacts_at_start
  use sg_error, only: diagnostics_t, error_t
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_system, only: file_exists
  use written_files, only: shared_folder
  implicit none
  type(tests_t) :: tests
  character(len=320) :: decks = ''

  call test_decks()
  call tests%finish()

contains

  !> LMGC90's own decks, where they are at hand: counts, and the total mass that LMGC90 found.
  subroutine test_decks()
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics

    call read_datbox('datbox_of_nobody', scene, diagnostics)
    call tests%equal(diagnostics%count(), 1, 'a folder that is not there is refused once')
    decks = shared_folder()//'/decks/'
    if (.not. file_exists(trim(decks)//'1024DK_BoxJC/DATBOX/BODIES.DAT')) then
      write (*, '(a)') 'the decks of LMGC90 are not at hand: skipped'
      return
    end if
    call test_deck('1024DK_BoxJC', [1028, 1028, 5, 12, 0], 2.0736121352333057_wp)
    call test_deck('500PL_PerioBoxJC', [502, 502, 2, 6, 1662], 1555.7495353189004_wp)
    call test_deck('WallPL_GroundJC', [106, 106, 6, 15, 664], 4000.000704973795_wp)
    call test_deck('BouncingBallsDK', [4, 4, 3, 3, 0], 1022.8318548202516_wp)
    call test_deck('DDM_2d_rough_box', [545, 609, 2, 12, 0], 0.0_wp)
    call test_deck('MembraneBiaxialDK_Iso', [4760, 4760, 5, 12, 0], 32799778.968017_wp)
    call test_deck('MembraneBiaxialDK_Defo', [4760, 4760, 5, 6, 0], 0.0_wp)
    call test_deck('bench_disk_45', [2025, 2025, 1, 0, 0], 0.0_wp)
    call test_deck('945_SP_Box_PL', [950, 950, 2, 30, 0], 0.0_wp)
    call test_deck('Wall_PR', [106, 106, 6, 30, 1116], 400.0048_wp)
    call test_deck('bench_sphere_12', [1728, 1728, 1, 0, 0], 0.0_wp)
    call test_deck('bench_poly_10', [1000, 1000, 1, 0, 0], 0.0_wp)
  end subroutine test_decks

  !> One deck.
  subroutine test_deck(name, counts, mass)
    character(len=*), intent(in) :: name
    integer, intent(in) :: counts(5)
    real(wp), intent(in) :: mass
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics

    call read_datbox(trim(decks)//name//'/DATBOX', scene, diagnostics)
    call tests%equal(diagnostics%count(), 0, name//' is read')
    if (diagnostics%count() > 0) then
      call diagnostics%print(6)
      return
    end if
    call tests%equal(scene%bodies%n, counts(1), 'bodies of '//name)
    call tests%equal(scene%contactors%n, counts(2), 'contactors of '//name)
    call tests%equal(size(scene%sees), counts(3), 'see tables of '//name)
    call tests%equal(size(scene%drives), counts(4), 'drives of '//name)
    call tests%equal(size(scene%start_contacts), counts(5), 'contacts of '//name)
    ! LMGC90 takes pi in single precision, 2.8e-8 too large.
    if (mass > 0) call tests%near(sum(scene%bodies%mass), mass, 5e-8_wp*mass, 'mass of '//name)
    call test_round_trip(scene, name)
  end subroutine test_deck

  !> A scene written and read again is the same: seven digits or better, as the format holds eight.
  subroutine test_round_trip(a, name)
    type(scene_t), intent(in) :: a
    character(len=*), intent(in) :: name
    type(scene_t) :: b
    type(diagnostics_t) :: diagnostics
    type(error_t), allocatable :: error
    integer :: n, i

    call write_datbox('datbox_deck', a, contacts_at_start(a), a%start_time, int(a%start_step), error)
    call tests%check(.not. allocated(error), name//' is written')
    call read_datbox('datbox_deck', b, diagnostics)
    call tests%equal(diagnostics%count(), 0, name//' is read again')
    if (diagnostics%count() > 0) return
    ! The displacement holds what the place loses: positions keep more than twelve digits.
    call tests%check(all(abs(a%bodies%position - b%bodies%position) <= 1e-12_wp*max(1.0_wp, maxval(abs(a%bodies%position)))), &
                     'positions of '//name)
    call tests%check(all(abs(a%bodies%mass - b%bodies%mass) <= 1e-7_wp*a%bodies%mass), 'masses of '//name)
    call tests%check(a%dimension == b%dimension, 'dimension of '//name)
    if (a%dimension == 2) then
      call tests%check(all(abs(a%bodies%inertia - b%bodies%inertia) <= 2e-7_wp*a%bodies%inertia), 'inertias of '//name)
    else
      ! The axes of these bodies are written as they are: all shapes that are alone stand upright.
      call tests%check(all(abs(a%bodies%principal - b%bodies%principal) <= 2e-7_wp*a%bodies%principal), 'inertias of '//name)
      call tests%check(all(abs(a%bodies%orientation - b%bodies%orientation) <= 2e-7_wp), 'orientations of '//name)
    end if
    call tests%check(all(abs(a%bodies%velocity - b%bodies%velocity) <= 1e-7_wp*abs(a%bodies%velocity)), 'velocities of '//name)
    call tests%check(size(a%sees) == size(b%sees) .and. size(a%drives) == size(b%drives), 'see tables and drives of '//name)
    n = size(a%start_contacts)
    call tests%equal(size(b%start_contacts), n, 'contacts again of '//name)
    ! In the plane the components are written, in space those along a frame.
    if (a%dimension == 2) call tests%check(all([(abs(a%start_contacts(i)%force - b%start_contacts(i)%force) &
                                                 <= 1e-7_wp*abs(a%start_contacts(i)%force), i=1, n)]), 'forces of '//name)
    call tests%check(all([(norm2(a%start_contacts(i)%force - b%start_contacts(i)%force) &
                           <= 2e-7_wp*norm2(a%start_contacts(i)%force), i=1, n)]), 'sizes of forces of '//name)
    call tests%check(all([(a%start_contacts(i)%contactor == b%start_contacts(i)%contactor, i=1, n)]), 'pairs of '//name)
  end subroutine test_round_trip
end program test_datbox_decks
