!> Laws whose gaps count from that of the first step with contacts: grains that are in reach then stop where they were detected,
!! later ones at contact, in the plane and in space; a restart in between changes nothing; and a shifted gap.
program test_reference_gap
  use fresh_simulations, only: fresh
  use harness, only: tests_t
  use scenes, only: begin_run, begin_scene, put_disk, put_wall, run
  use scenes_space, only: begin_space_scene, put_plane, put_sphere
  use sg_checkpoint, only: load_checkpoint, save_checkpoint
  use sg_error, only: diagnostics_t, error_t
  use sg_hdf5, only: hdf5_is_available
  use sg_kinds, only: wp
  use sg_laws, only: law_elastic_g0, law_gap_g0, law_gap_shifted, law_iqs_g0
  use sg_simulation, only: simulation_t
  use sg_system, only: make_folder, remove_file
  implicit none
  character(len=*), parameter :: folder = 'reference_gap'
  real(wp), parameter :: h = 1e-3_wp, radius = 0.1_wp
  ! Positions of order one after some hundred steps.
  real(wp), parameter :: rounding = 1e-13_wp
  type(tests_t) :: t
  integer :: dimension

  do dimension = 2, 3
    call test_law(dimension, law_iqs_g0, 0.0_wp, 0.0095_wp, 0.0_wp)
    call test_law(dimension, law_gap_g0, 0.0_wp, 0.0095_wp, 0.0_wp)
    call test_law(dimension, law_gap_shifted, -0.02_wp, 0.02_wp, 0.02_wp, places=[0.04_wp, 0.1_wp])
    call test_spring(dimension)
    ! Nothing is in reach for 55 steps: the first contact is that of the nearer grain, at the edge of the alert distance.
    call test_law(dimension, law_iqs_g0, 0.0_wp, 0.0495_wp, 0.0_wp, places=[0.1_wp, 0.15_wp])
  end do
  if (hdf5_is_available()) call test_restart()
  if (hdf5_is_available()) call test_late_restart()
  call t%finish()

contains

  !> Two grains without weight move towards a floor at 1 m/s; the first is within the alert distance of 0.05 m.
  subroutine make(dimension, kind, shift, places, sim)
    integer, intent(in) :: dimension, kind
    real(wp), intent(in) :: shift, places(2)
    type(simulation_t), pointer, intent(out) :: sim
    integer :: b

    sim => fresh()
    if (dimension == 2) then
      call begin_scene(sim%scene, 3, 0.3_wp, 0.05_wp)
      call put_wall(sim%scene, 3, 3.0_wp, 0.1_wp, [0.0_wp, -0.1_wp], 0.0_wp)
    else
      call begin_space_scene(sim%scene, 3, 0.3_wp, 0.05_wp)
      call put_plane(sim%scene, 3, [3.0_wp, 3.0_wp, 0.1_wp], [0.0_wp, 0.0_wp, -0.1_wp])
    end if
    do b = 1, 2
      if (dimension == 2) call put_disk(sim%scene, b, radius, [real(b, wp), places(b) + radius])
      if (dimension == 3) call put_sphere(sim%scene, b, radius, [real(b, wp), 0.0_wp, places(b) + radius])
      sim%scene%bodies%velocity(dimension, b) = -1
    end do
    sim%scene%gravity = 0
    sim%scene%laws(1)%kind = kind
    sim%scene%laws(1)%gap_shift = shift
    sim%scene%laws(1)%stiffness = 1e6_wp
    sim%options%folder = folder
    sim%options%deck_hash = 'cafe'
    call begin_run(sim, h, 1e-12_wp)
  end subroutine make

  !> Gaps between the two grains and the floor [m].
  pure function gaps(sim)
    type(simulation_t), intent(in) :: sim
    real(wp) :: gaps(2)

    gaps = sim%scene%bodies%position(sim%scene%dimension, :2) - radius
  end function gaps

  !> Where both grains stop.
  subroutine test_law(dimension, kind, shift, first, second, places)
    integer, intent(in) :: dimension, kind
    real(wp), intent(in) :: shift
    real(wp), intent(in) :: first, second !! gaps expected at the end [m]
    real(wp), intent(in), optional :: places(2) !! gaps at the start [m]
    type(simulation_t), pointer :: sim
    real(wp) :: at(2)

    at = [0.01_wp, 0.1_wp]
    if (present(places)) at = places
    call make(dimension, kind, shift, at, sim)
    call run(sim, 200)
    call t%near(maxval(abs(gaps(sim) - [first, second])), 0.0_wp, rounding, 'where grains stop')
    call t%near(maxval(abs(sim%scene%bodies%velocity(dimension, :2))), 0.0_wp, rounding, 'they rest')
  end subroutine test_law

  !> The spring of the elastic law is relaxed at the first gap: force and gap obey r = -h k (gap + h u - first gap) in each step.
  subroutine test_spring(dimension)
    integer, intent(in) :: dimension
    type(simulation_t), pointer :: sim
    real(wp) :: worst, impulse
    integer :: step, k

    call make(dimension, law_elastic_g0, 0.0_wp, [0.01_wp, 0.1_wp], sim)
    worst = 0
    do step = 1, 150
      call run(sim, 1)
      do k = 1, sim%contacts%n
        if (.not. any(abs(sim%contacts%impulse(:, k)) > 0)) cycle
        impulse = abs(sim%contacts%impulse(merge(1, 3, dimension == 2), k))
        associate (body => sim%contacts%body(1, k), first => sim%contacts%internal(1, k))
          worst = max(worst, abs(impulse + h*1e6_wp*(sim%contacts%gap(k) + h*sim%scene%bodies%velocity(dimension, body) - first)))
          call t%near(first, merge(0.0095_wp, 0.0_wp, body == 1), rounding, 'the gap from which a spring counts')
        end associate
      end do
    end do
    ! Impulses of up to 30 N s, from a stiffness of 1000 N s/m times gaps.
    call t%near(worst, 0.0_wp, 1e-10_wp, 'force of the spring')
  end subroutine test_spring

  !> A run continued from a checkpoint ends in the very same places.
  subroutine test_restart()
    type(simulation_t), pointer :: straight, second, other
    type(error_t), allocatable :: error
    type(diagnostics_t) :: warnings

    call t%check(make_folder(folder), 'the folder is there')
    call remove_file(folder//'/restart_a.h5')
    call remove_file(folder//'/restart_b.h5')
    call make(2, law_iqs_g0, 0.0_wp, [0.01_wp, 0.1_wp], straight)
    call run(straight, 30)
    call save_checkpoint(straight, error)
    call t%check(.not. allocated(error), 'a checkpoint is written')
    call run(straight, 170)
    call make(2, law_iqs_g0, 0.0_wp, [0.01_wp, 0.1_wp], second)
    call load_checkpoint(second, folder, warnings, error)
    call t%check(.not. allocated(error), 'it is read')
    if (allocated(error)) return
    call run(second, 170)
    call t%near(maxval(abs(gaps(second) - gaps(straight))), 0.0_wp, 0.0_wp, 'restarted is straight')
    call t%near(maxval(abs(gaps(second) - [0.0095_wp, 0.0_wp])), 0.0_wp, rounding, 'restarted: where grains stop')
    call make(2, law_gap_shifted, 0.0_wp, [0.01_wp, 0.1_wp], other)
    call load_checkpoint(other, folder, warnings, error)
    call t%check(allocated(error), 'a scene whose laws keep nothing does not go on from it')
  end subroutine test_restart

  !> A run continued from a checkpoint of before the first contact has the same first contact; one of after it has no second one.
  subroutine test_late_restart()
    type(simulation_t), pointer :: sim
    type(error_t), allocatable :: error
    type(diagnostics_t) :: warnings
    integer :: i, before

    do i = 1, 2
      before = merge(30, 80, i == 1)
      call make(2, law_iqs_g0, 0.0_wp, [0.1_wp, 0.15_wp], sim)
      call run(sim, before)
      call save_checkpoint(sim, error)
      call t%check(.not. allocated(error), 'a checkpoint is written')
      call make(2, law_iqs_g0, 0.0_wp, [0.1_wp, 0.15_wp], sim)
      call load_checkpoint(sim, folder, warnings, error)
      call t%check(.not. allocated(error), 'it is read')
      if (allocated(error)) return
      call run(sim, 200 - before)
      call t%near(maxval(abs(gaps(sim) - [0.0495_wp, 0.0_wp])), 0.0_wp, rounding, 'restarted: where grains stop')
    end do
  end subroutine test_late_restart
end program test_reference_gap
