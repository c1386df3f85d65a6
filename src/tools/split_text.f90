!> A split of grains as a table and as one flat JSON object (figures: doc/theory/partition.md).
module sg_split_text
  use sg_columns, only: fixed
  use sg_interface_blocks, only: block_structure_t
  use sg_json, only: json_t
  use sg_kinds, only: wp
  use sg_print, only: print_line
  use sg_split_report, only: split_report_t
  use sg_text, only: to_text
  implicit none
  private
  public :: print_split

contains

  !> Print the whole, then one line per part; or one flat JSON object.
  subroutine print_split(report, blocks, as_json)
    type(split_report_t), intent(in) :: report !! figures of the split
    type(block_structure_t), intent(in) :: blocks !! the matrix of the primal interface
    logical, intent(in) :: as_json !! as JSON?
    character(len=*), parameter :: nl = new_line('a')
    character(len=:), allocatable :: text
    character(len=75) :: row
    integer :: i

    if (as_json) then
      call print_line(split_json(report, blocks))
      return
    end if
    text = 'split        '//to_text(report%grains)//' grains into '//to_text(size(report%part_grains))//' parts by '// &
           report%method
    if (all(report%boxes > 0)) then
      text = text//', '//to_text(report%boxes(1))//' along x, '//to_text(report%boxes(2))//' along y'
      if (report%boxes(3) > 1) text = text//', '//to_text(report%boxes(3))//' along z'
    end if
    call print_line(text//nl// &
      'contacts     '//to_text(report%contacts)//' between grains, '//to_text(report%wall_contacts)//' with walls'//nl// &
      'imbalance    '//fixed(report%imbalance, 3)//' largest over mean load, '//fixed(report%contact_imbalance, 3)// &
        ' of contacts owned'//nl// &
      'primal       '//to_text(report%cut_contacts)//' of '//to_text(report%contacts)//' contacts between parts ('// &
        percent(report%cut_contacts, report%contacts)//'), of '//to_text(report%interface_grains)//' grains')
    if (blocks%contacts > 0) then
      call print_line( &
        'W_gamma      off-diagonal blocks per row: mean '//fixed(blocks%mean_couplings, 3)//', max '// &
          to_text(blocks%most_couplings)//'; none in '//percent(blocks%alone, blocks%contacts)//' of rows'//nl// &
        '             '//to_text(blocks%groups)//' independent groups of contacts, the largest of '// &
          to_text(blocks%largest_group)//'; norm of off-diagonal blocks over that of diagonal ones '// &
          fixed(blocks%off_diagonal, 3))
    end if
    text = 'dual         '//to_text(report%multiplicity(1))//' grains in 1 part'
    do i = 2, size(report%multiplicity)
      text = text//', '//to_text(report%multiplicity(i))//' in '//to_text(i)
    end do
    call print_line(text//nl//'     part     grains       load      inner      owned       held neighbours')
    do i = 1, size(report%part_grains)
      write (row, '(i9,6(2x,i9))') i, report%part_grains(i), nint(report%part_load(i)), report%part_inner(i), &
        report%part_owned(i), report%part_held(i), report%part_neighbours(i)
      call print_line(row)
    end do
  end subroutine print_split

  !> A share in percent.
  pure function percent(some, all) result(word)
    integer, intent(in) :: some, all
    character(len=:), allocatable :: word

    word = fixed(100*real(some, wp)/real(max(1, all), wp), 1)//' %'
  end function percent

  !> The whole as one flat object; parts by their extremes.
  function split_json(report, blocks) result(text)
    type(split_report_t), intent(in) :: report
    type(block_structure_t), intent(in) :: blocks
    character(len=:), allocatable :: text
    type(json_t) :: json
    integer :: i

    call json%add('method', report%method)
    call json%add('parts', size(report%part_grains))
    call json%add('boxes_x', report%boxes(1))
    call json%add('boxes_y', report%boxes(2))
    call json%add('boxes_z', report%boxes(3))
    call json%add('grains', report%grains)
    call json%add('contacts', report%contacts)
    call json%add('wall_contacts', report%wall_contacts)
    call json%add('imbalance', report%imbalance)
    call json%add('contact_imbalance', report%contact_imbalance)
    call json%add('cut_contacts', report%cut_contacts)
    call json%add('interface_grains', report%interface_grains)
    call json%add('smallest_part', minval(report%part_grains))
    call json%add('largest_part', maxval(report%part_grains))
    call json%add('least_load', minval(report%part_load))
    call json%add('largest_load', maxval(report%part_load))
    call json%add('fewest_owned', minval(report%part_owned))
    call json%add('most_owned', maxval(report%part_owned))
    call json%add('grains_held', sum(report%part_held))
    call json%add('most_neighbours', maxval(report%part_neighbours))
    do i = 1, size(report%multiplicity)
      call json%add('grains_in_'//to_text(i), report%multiplicity(i))
    end do
    call json%add('gamma_contacts', blocks%contacts)
    call json%add('gamma_alone', blocks%alone)
    call json%add('gamma_mean_couplings', blocks%mean_couplings)
    call json%add('gamma_most_couplings', blocks%most_couplings)
    call json%add('gamma_groups', blocks%groups)
    call json%add('gamma_largest_group', blocks%largest_group)
    call json%add('gamma_off_diagonal', blocks%off_diagonal)
    text = json%text()
  end function split_json
end module sg_split_text
