!> Figures of a benchmark as a table and as one flat JSON object.
module sg_benchmark_text
  use sg_benchmark, only: benchmark_t
  use sg_columns, only: right
  use sg_kinds, only: wp
  use sg_print, only: print_line
  use sg_run_options, only: solver_options_t
  use sg_text, only: to_text
  implicit none
  private
  public :: print_figures

contains

  !> Print the figures, one a line or as one flat JSON object.
  subroutine print_figures(shape, figures, options, as_json)
    character(len=*), intent(in) :: shape !! shape of the grains
    type(benchmark_t), intent(in) :: figures !! what was measured
    type(solver_options_t), intent(in) :: options !! options of the sweeps
    logical, intent(in) :: as_json !! as JSON?

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
end module sg_benchmark_text
