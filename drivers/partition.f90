!> `splitgrain partition`: how the grains of a deck would be split, without a run.
module sg_partition
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use sg_arguments, only: arguments_t
  use sg_deck, only: read_deck
  use sg_error, only: diagnostics_t, error_t, exit_bad_input, exit_done, fail
  use sg_kinds, only: wp
  use sg_simulation, only: simulation_t
  use sg_split_report, only: split_report_t
  use sg_split_text, only: print_split, split_json
  use sg_start_split, only: split_at_start
  implicit none
  private
  public :: partition_command

contains

  !> Split and print.
  subroutine partition_command(arguments, code, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! what went wrong
    type(simulation_t) :: sim
    type(diagnostics_t) :: diagnostics
    type(split_report_t) :: report
    character(len=:), allocatable :: method
    real(wp) :: parts

    code = exit_done
    method = arguments%get('method', 'boxes')
    call arguments%expect('parts method set json', 1, 1, 'partition DECK --parts N [options]', error)
    if (.not. allocated(error)) call arguments%number('parts', 0.0_wp, 1.0_wp, parts, error)
    if (.not. allocated(error) .and. .not. arguments%has('parts')) call fail(error, 'how many parts? Give --parts N')
    if (.not. allocated(error) .and. all(method /= [character(len=5) :: 'boxes', 'graph'])) then
      call fail(error, 'method is boxes or graph, not "'//method//'"')
    end if
    if (allocated(error)) return
    call read_deck(arguments%words(1)%s, arguments%all_of('set'), sim%scene, sim%options, diagnostics)
    call diagnostics%print(error_unit)
    if (diagnostics%count() > 0) then
      code = exit_bad_input
      return
    end if
    call split_at_start(sim, method, nint(parts), report, error)
    if (allocated(error)) return
    if (arguments%has('json')) then
      write (output_unit, '(a)') split_json(report)
    else
      call print_split(output_unit, report)
    end if
  end subroutine partition_command
end module sg_partition
