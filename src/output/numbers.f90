!> numbers.tag: the results of a run as tagged numbers, for regression cases.
module sg_numbers
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_run_summary, only: run_summary_t
  use sg_tagged, only: tagged_text
  use sg_tally, only: column_t
  use sg_text_files, only: replace_file
  implicit none
  private
  public :: write_numbers

contains

  !> Write the measures and counts of a concluded run, wholly or not at all.
  subroutine write_numbers(summary, file, error)
    type(run_summary_t), intent(in) :: summary !! concluded run
    character(len=*), intent(in) :: file !! path of the file
    type(error_t), allocatable, intent(out) :: error !! set when it cannot be written
    type(column_t), allocatable :: columns(:)
    character(len=:), allocatable :: text
    integer :: i

    if (.not. summary%is_root) return
    text = tagged_text('steps', 'count', [real(summary%totals%steps, wp)])// &
           tagged_text('contacts', 'count', [real(summary%totals%contacts, wp)])// &
           tagged_text('active_contacts', 'count', [real(summary%totals%active_contacts, wp)])// &
           tagged_text('sweeps', 'effort', [real(summary%totals%sweeps, wp)])
    columns = summary%columns()
    do i = 1, size(columns)
      text = text//tagged_text(trim(columns(i)%name), trim(merge('count  ', 'measure', columns(i)%is_count)), [columns(i)%value])
    end do
    call replace_file(file, text, error)
  end subroutine write_numbers
end module sg_numbers
