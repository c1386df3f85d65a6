!> A split of grains as a table and as one flat JSON object (doc/theory/partition.md says what the figures are).
module sg_split_text
  use sg_json, only: json_t
  use sg_kinds, only: wp
  use sg_split_report, only: split_report_t
  use sg_text, only: to_text
  implicit none
  private
  public :: print_split, split_json

contains

  !> Print the whole, then one line a part.
  subroutine print_split(unit, report)
    integer, intent(in) :: unit !! open unit
    type(split_report_t), intent(in) :: report !! figures of the split
    character(len=:), allocatable :: text
    integer :: i

    text = 'split        '//to_text(report%grains)//' grains into '//to_text(size(report%part_grains))//' parts by '// &
           report%method
    if (all(report%boxes > 0)) text = text//', '//to_text(report%boxes(1))//' along x and '//to_text(report%boxes(2))//' along y'
    write (unit, '(a)') text, &
      'imbalance    '//fixed(report%imbalance)//' largest over mean weight', &
      'cut          '//to_text(report%cut_contacts)//' of '//to_text(report%contacts)//' contacts between grains', &
      'interface    '//to_text(report%interface_grains)//' grains'
    text = 'multiplicity '//to_text(report%multiplicity(1))//' grains in 1 part'
    do i = 2, size(report%multiplicity)
      text = text//', '//to_text(report%multiplicity(i))//' in '//to_text(i)
    end do
    write (unit, '(a)') text, '     part     grains     weight  interface'
    do i = 1, size(report%part_grains)
      write (unit, '(i9,3(2x,i9))') i, report%part_grains(i), report%part_weight(i), report%part_interface(i)
    end do
  end subroutine print_split

  !> A number with three decimals.
  pure function fixed(value) result(word)
    real(wp), intent(in) :: value
    character(len=:), allocatable :: word
    character(len=24) :: buffer

    write (buffer, '(f24.3)') value
    word = trim(adjustl(buffer))
  end function fixed

  !> The whole as one flat object; parts by their extremes.
  function split_json(report) result(text)
    type(split_report_t), intent(in) :: report !! figures of the split
    character(len=:), allocatable :: text
    type(json_t) :: json
    integer :: i

    call json%add('method', report%method)
    call json%add('parts', size(report%part_grains))
    call json%add('boxes_x', report%boxes(1))
    call json%add('boxes_y', report%boxes(2))
    call json%add('grains', report%grains)
    call json%add('contacts', report%contacts)
    call json%add('imbalance', report%imbalance)
    call json%add('cut_contacts', report%cut_contacts)
    call json%add('interface_grains', report%interface_grains)
    call json%add('smallest_part', minval(report%part_grains))
    call json%add('largest_part', maxval(report%part_grains))
    do i = 1, size(report%multiplicity)
      call json%add('grains_in_'//to_text(i), report%multiplicity(i))
    end do
    text = json%text()
  end function split_json
end module sg_split_text
