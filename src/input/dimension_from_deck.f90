!> The dimension of a deck's scene: the one that it gives, or that of its DATBOX, or the plane.
module sg_dimension_from_deck
  use sg_blocks, only: deck_t
  use sg_collect, only: choose_dimension
  use sg_kinds, only: wp
  use sg_time_function_from_deck, only: path_in_deck
  use sg_values, only: value_t
  implicit none
  private
  public :: dimension_from_deck

contains

  !> Find the dimension and take its defaults.
  subroutine dimension_from_deck(deck)
    type(deck_t), intent(inout) :: deck !! deck of which all entries are taken, not yet checked
    type(value_t) :: value
    integer :: b, dimension

    b = deck%block_of('scene')
    dimension = 2
    if (deck%is_given(b, 'dimension')) then
      value = deck%value(b, 'dimension')
      if (.not. value%is_bad) dimension = nint(value%numbers(1))
    else if (deck%is_given(b, 'datbox')) then
      value = deck%value(b, 'datbox')
      if (.not. value%is_bad) dimension = dimension_of_datbox(path_in_deck(deck, value%words(1)%s))
      if (dimension == 3) call deck%give_numbers(b, 'dimension', [3.0_wp])
    end if
    call choose_dimension(deck, dimension)
  end subroutine dimension_from_deck

  !> Dimension of an LMGC90 folder: nodes of rigid bodies have three components in the plane (NO3xx), six in space (NO6xx).
  integer function dimension_of_datbox(folder) result(dimension)
    character(len=*), intent(in) :: folder
    character(len=256) :: line
    integer :: unit, status

    dimension = 2
    open (newunit=unit, file=folder//'/BODIES.DAT', status='old', action='read', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (index(line, 'NO6xx') > 0) dimension = 3
      if (index(line, 'NO6xx') > 0 .or. index(line, 'NO3xx') > 0) exit
    end do
    close (unit)
  end function dimension_of_datbox
end module sg_dimension_from_deck
