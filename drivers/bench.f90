!> `splitgrain bench`: how fast the sweeps of this build are on this machine.
module sg_bench
  use sg_arguments, only: arguments_t
  use sg_benchmark, only: benchmark_t, run_benchmark
  use sg_benchmark_scenes, only: check_lattice
  use sg_benchmark_text, only: print_figures
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp
  use sg_run_options, only: solver_options_t
  use sg_threads, only: threads_are_available
  implicit none
  private
  public :: bench_command

contains

  !> Measure and print.
  subroutine bench_command(arguments, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(error_t), allocatable, intent(out) :: error !! error of the command line
    type(solver_options_t) :: options
    type(benchmark_t) :: figures
    real(wp) :: friction
    integer :: contacts
    character(len=:), allocatable :: shape

    call arguments%expect('shape contacts friction order threads check-every sweeps momentum json', 0, 0, 'bench [options]', error)
    if (.not. allocated(error)) call arguments%whole('contacts', 100000, 12, contacts, error)
    if (.not. allocated(error)) call arguments%number('friction', 0.3_wp, 0.0_wp, friction, error)
    if (.not. allocated(error)) call arguments%whole('check-every', options%typical_gap(), 1, options%check_every, error)
    ! About a second's work where nothing is given.
    if (.not. allocated(error)) &
      call arguments%whole('sweeps', min(20000, max(100, 100000000/contacts)), 1, options%maximum_sweeps, error)
    shape = arguments%get('shape', 'disk')
    options%order = arguments%get('order', options%order)
    if (.not. allocated(error) .and. all(options%order /= [character(len=16) :: 'natural', 'groups', 'coloured'])) then
      call fail(error, 'order is natural, groups or coloured, not "'//trim(options%order)//'"')
    end if
    if (.not. allocated(error)) call arguments%whole('threads', 1, 1, options%threads, error)
    if (allocated(error)) return
    if (options%threads > 1 .and. .not. threads_are_available()) then
      call fail(error, 'this program was built without OpenMP, which more than one thread needs')
    else if (options%threads > 1 .and. options%order /= 'coloured') then
      call fail(error, 'threads share sweeps in coloured order alone')
    end if
    call check_lattice(shape, contacts, error)
    if (allocated(error)) return
    options%check_every = min(options%check_every, options%maximum_sweeps)
    options%method = 'nlgs'
    if (arguments%has('momentum')) options%method = 'nesterov'
    call run_benchmark(shape, contacts, friction, options, figures)
    call print_figures(shape, figures, options, arguments%has('json'))
  end subroutine bench_command
end module sg_bench
