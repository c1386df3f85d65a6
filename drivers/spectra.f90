!> `splitgrain spectrum`: spectral radii of interface iterations on the first contact problem of a deck.
module sg_spectra
  use sg_arguments, only: arguments_t
  use sg_comm, only: comm_t
  use sg_contraction, only: contraction_t
  use sg_error, only: error_t, exit_done, fail
  use sg_kinds, only: wp
  use sg_numerals, only: read_real
  use sg_print, only: print_line
  use sg_scene_argument, only: read_scene_argument
  use sg_simulation, only: simulation_t
  use sg_spectral_radii, only: first_problem, radii_of, spectral_radii_t
  use sg_spectral_text, only: contraction_text, search_directions, spectral_csv, spectral_table
  use sg_text, only: text_t
  use sg_text_files, only: replace_file
  implicit none
  private
  public :: spectrum_command

contains

  !> Find the radii, print a table, and write them against eta.
  subroutine spectrum_command(arguments, comm, code, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(comm_t), intent(in) :: comm !! this rank alone
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! error of the command
    type(simulation_t) :: sim
    type(contraction_t) :: contraction
    type(spectral_radii_t), allocatable :: radii(:)
    real(wp), allocatable :: epsilon(:)
    real(wp) :: own
    integer :: parts, points, i
    logical :: is_linear

    code = exit_done
    call arguments%expect('parts epsilon points csv restart set', 1, 1, 'spectrum DECK [options]', error)
    if (.not. allocated(error)) call arguments%whole('points', 20, 1, points, error)
    if (.not. allocated(error)) call read_epsilons(arguments%all_of('epsilon'), epsilon, error)
    if (.not. allocated(error)) call read_scene_argument(arguments, comm, sim%scene, sim%options, code, error)
    if (allocated(error) .or. code /= exit_done) return
    call arguments%whole('parts', max(2, sim%options%partition%parts), 2, parts, error)
    if (.not. allocated(error)) call first_problem(sim, parts, contraction, is_linear, own, error)
    if (allocated(error)) return
    epsilon = epsilon*contraction%epsilon_0
    if (size(epsilon) == 0 .or. .not. is_linear) epsilon = [own]
    allocate (radii(size(epsilon)))
    do i = 1, size(epsilon)
      call radii_of(contraction, is_linear, epsilon(i), contraction%epsilon_0*search_directions(points), radii(i), error)
      if (allocated(error)) return
    end do
    call print_line(contraction_text(contraction, is_linear, parts))
    call print_line(spectral_table(radii, is_linear, contraction%epsilon_0))
    if (arguments%has('csv')) call replace_file(arguments%get('csv', ''), spectral_csv(radii, contraction%epsilon_0), error)
  end subroutine spectrum_command

  !> Take the list of epsilons from the command line, each over the mean diagonal term of W.
  subroutine read_epsilons(words, epsilon, error)
    type(text_t), intent(in) :: words(:)
    real(wp), allocatable, intent(out) :: epsilon(:)
    type(error_t), allocatable, intent(out) :: error
    logical :: is_number
    integer :: i

    allocate (epsilon(size(words)), source=0.0_wp)
    do i = 1, size(words)
      call read_real(words(i)%s, epsilon(i), is_number)
      if (.not. (is_number .and. epsilon(i) > 0)) &
        call fail(error, 'option --epsilon needs a number above zero, not "'//words(i)%s//'"')
    end do
  end subroutine read_epsilons
end module sg_spectra
