!> numbers.tag: the results of a run as tagged numbers, for regression cases.
module sg_numbers
  use sg_error, only: error_t, exit_output, fail
  use sg_kinds, only: wp
  use sg_measures, only: is_count, measure_names, n_measures
  use sg_run_summary, only: run_summary_t
  use sg_system, only: remove_file, rename_file
  use sg_tagged, only: write_tagged
  implicit none
  private
  public :: write_numbers

contains

  !> Write the measures and counts of a concluded run, wholly or not at all.
  subroutine write_numbers(summary, file, error)
    type(run_summary_t), intent(in) :: summary !! concluded run
    character(len=*), intent(in) :: file !! path of the file
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    integer :: unit, status, i

    open (newunit=unit, file=file//'.part', status='replace', action='write', iostat=status)
    if (status == 0) then
      call write_tagged(unit, 'steps', 'count', [real(summary%totals%steps, wp)])
      call write_tagged(unit, 'contacts', 'count', [real(summary%totals%contacts, wp)])
      call write_tagged(unit, 'active_contacts', 'count', [real(summary%totals%active_contacts, wp)])
      call write_tagged(unit, 'sweeps', 'effort', [real(summary%totals%sweeps, wp)])
      do i = 1, n_measures
        call write_tagged(unit, trim(measure_names(i)), trim(merge('count  ', 'measure', is_count(i))), [summary%measures%value(i)])
      end do
      close (unit, iostat=status)
    end if
    if (status == 0) then
      if (rename_file(file//'.part', file)) return
    end if
    call remove_file(file//'.part')
    call fail(error, 'cannot write the tagged numbers', file=file, code=exit_output)
  end subroutine write_numbers
end module sg_numbers
