!> `splitgrain bench`: how fast the sweeps of this build are on this machine.
module sg_bench
  use sg_arguments, only: arguments_t
  use sg_benchmark, only: benchmark_t, run_benchmark
  use sg_benchmark_scenes, only: check_lattice, lattice_shapes
  use sg_columns, only: right
  use sg_error, only: error_t, fail
  use sg_kinds, only: wp
  use sg_print, only: print_line
  use sg_run_options, only: solver_options_t
  use sg_text, only: to_text
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

    call arguments%expect('shape contacts friction order threads check-every sweeps json', 0, 0, 'bench [options]', error)
    if (.not. allocated(error)) call arguments%whole('contacts', 100000, 12, contacts, error)
    if (.not. allocated(error)) call arguments%number('friction', 0.3_wp, 0.0_wp, friction, error)
    if (.not. allocated(error)) call arguments%whole('check-every', (options%check_every), 1, options%check_every, error)
    ! About a second's work where nothing is given.
    if (.not. allocated(error)) &
      call arguments%whole('sweeps', min(20000, max(100, 100000000/contacts)), 1, options%maximum_sweeps, error)
    shape = arguments%get('shape', 'disk')
    if (.not. allocated(error) .and. all(lattice_shapes /= shape)) then
      call fail(error, 'bench has the shapes disk, sphere and polyhedron, not "'//shape//'"')
    end if
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
    if (.not. allocated(error)) call check_lattice(contacts, error)
    if (allocated(error)) return
    options%check_every = min(options%check_every, options%maximum_sweeps)
    call run_benchmark(shape, contacts, friction, options, figures)
    call print_figures(shape, figures, options, arguments%has('json'))
  end subroutine bench_command

  !> Print the figures, one a line or as one flat JSON object.
  subroutine print_figures(shape, figures, options, as_json)
    character(len=*), intent(in) :: shape
    type(benchmark_t), intent(in) :: figures
    type(solver_options_t), intent(in) :: options
    logical, intent(in) :: as_json

    if (as_json) call print_line('{"shape": "'//shape//'", "order": "'//trim(options%order)//'"', is_open=.true.)
    call put('contacts', real(figures%contacts, wp))
    call put('active_contacts', real(figures%active_contacts, wp))
    call put('sweeps', real(figures%sweeps, wp))
    call put('contact_updates_per_cpu_second', figures%updates_per_second)
    call put('threads', real(options%threads, wp))
    call put('contact_updates_per_second', figures%updates_per_wall_second)
    call put('check_every', real(options%check_every, wp))
    call put('check_share', figures%check_share)
    call put('sweep_seconds', figures%sweep_seconds)
    call put('first_detection_in_sweeps', figures%first_detect_seconds/figures%sweep_seconds)
    call put('detection_in_sweeps', figures%detect_seconds/figures%sweep_seconds)
    call put('assembly_in_sweeps', figures%assemble_seconds/figures%sweep_seconds)
    call put('stream_triad_bytes_per_second', figures%triad)
    call put('bytes_per_contact', figures%bytes_per_contact)
    call put('peak_bytes_per_contact', figures%peak_per_contact)
    call put('bytes_per_update', figures%bytes_per_update)
    call put('fraction_of_stream', figures%updates_per_second*figures%bytes_per_update/figures%triad)
    call put('e8', figures%e8)
    if (as_json) call print_line('}')
  contains
    subroutine put(name, value)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: value

      if (as_json) then
        call print_line(', "'//name//'": '//to_text(value, 6), is_open=.true.)
      else
        call print_line(right(name, 32)//' '//to_text(value, 4))
      end if
    end subroutine put
  end subroutine print_figures
end module sg_bench
