!> The scene that a command line names: a deck with settings and a restart file, or a lattice.
module sg_scene_argument
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sg_arguments, only: arguments_t
  use sg_benchmark_scenes, only: check_lattice, make_lattice
  use sg_blocks, only: deck_t
  use sg_comm, only: comm_t
  use sg_deck, only: read_share
  use sg_error, only: diagnostics_t, error_t, exit_bad_input, exit_done
  use sg_kinds, only: wp
  use sg_run_options, only: run_options_t
  use sg_scene, only: scene_t
  use sg_stop, only: stop_t
  use sg_stop_from_deck, only: stop_from_deck
  implicit none
  private
  public :: read_scene_argument

contains

  !> Read the deck, the first word, with --set over it, and print its mistakes; or make the lattice that `splitgrain bench` measures
  !! on. The options hold the file of --restart.
  subroutine read_scene_argument(arguments, comm, scene, options, code, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(comm_t), intent(in) :: comm !! the ranks, of which each reads the whole deck and the root rank prints
    type(scene_t), intent(out) :: scene !! what exists
    type(run_options_t), intent(out) :: options !! what to do with it
    integer, intent(out) :: code !! that of bad input where the deck has mistakes
    type(error_t), allocatable, intent(out) :: error !! set when there is no such lattice
    type(diagnostics_t) :: diagnostics
    type(deck_t) :: deck
    type(comm_t) :: alone
    type(stop_t) :: stops

    code = exit_done
    if (arguments%has('lattice')) then
      call make_scene(arguments, scene, error)
      options%time_step = 1e-4_wp
    else
      call read_share(arguments%words(1)%s, arguments%all_of('set'), alone, scene, options, deck, diagnostics)
      if (diagnostics%count() == 0) call stop_from_deck(deck, scene, options, stops, diagnostics)
      if (comm%rank == 0) call diagnostics%print(error_unit)
      if (diagnostics%count() > 0) code = exit_bad_input
    end if
    if (arguments%has('restart')) options%restart_file = arguments%get('restart', '')
  end subroutine read_scene_argument

  !> Make the lattice of --lattice and --shape.
  subroutine make_scene(arguments, scene, error)
    type(arguments_t), intent(in) :: arguments
    type(scene_t), intent(inout) :: scene
    type(error_t), allocatable, intent(out) :: error
    character(len=:), allocatable :: shape
    integer :: contacts

    shape = arguments%get('shape', 'disk')
    call arguments%whole('lattice', 0, 12, contacts, error)
    if (.not. allocated(error)) call check_lattice(shape, contacts, error)
    if (.not. allocated(error)) call make_lattice(scene, shape, contacts, 0.3_wp)
  end subroutine make_scene
end module sg_scene_argument
