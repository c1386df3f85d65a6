!> Spectral radii as a table and as CSV.
module sg_spectral_text
  use sg_columns, only: fixed, right
  use sg_contraction, only: contraction_t
  use sg_kinds, only: wp
  use sg_spectral_radii, only: spectral_radii_t
  use sg_step_csv, only: cell
  use sg_text, only: counted, to_text
  implicit none
  private
  public :: contraction_text, search_directions, spectral_csv, spectral_table

  character(len=*), parameter :: nl = new_line('a')
  !> Search directions go so many decades to either side of the mean diagonal term of W
  integer, parameter :: decades = 4

contains

  !> Search directions over the mean diagonal term of W.
  pure function search_directions(points) result(eta)
    integer, intent(in) :: points !! per decade
    real(wp) :: eta(2*decades*points + 1)
    integer :: i

    eta = [(10**(real(i, wp)/real(points, wp)), i=-decades*points, decades*points)]
  end function search_directions

  !> Sizes of the interface.
  function contraction_text(contraction, is_linear, parts) result(text)
    type(contraction_t), intent(in) :: contraction !! matrices
    logical, intent(in) :: is_linear !! are the interactions linear?
    integer, intent(in) :: parts !! subdomains
    character(len=:), allocatable :: text

    text = 'interface    '//counted(contraction%unknowns, 'unknown')//' of '//to_text(contraction%shared)//' shared bodies, '// &
           counted(parts, 'subdomain')//nl//'contacts     '//to_text(contraction%contacts)
    if (is_linear) then
      text = text//', linear'
    else
      text = text//', '//to_text(contraction%holding)//' of them carry an impulse'
    end if
    text = text//nl//'epsilon_0    '//cell(contraction%epsilon_0)//' 1/kg, mean diagonal term of W'
  end function contraction_text

  !> One line per epsilon: radius of the dual method, least radius of the enriched interface and where, from which eta it converges,
  !! and where it is below that of the dual method. All eta over the mean diagonal term of W.
  function spectral_table(radii, is_linear, epsilon_0) result(text)
    type(spectral_radii_t), intent(in) :: radii(:) !! radii for some epsilons
    logical, intent(in) :: is_linear !! are the interactions linear?
    real(wp), intent(in) :: epsilon_0 !! mean diagonal term of W [1/kg]
    character(len=:), allocatable :: text, name
    integer :: i, best

    text = '     epsilon        dual    enriched      at eta   converges from    below dual from          to'
    do i = 1, size(radii)
      associate (r => radii(i))
        name = 'contact'
        if (is_linear) name = to_text(r%epsilon/epsilon_0, 4)
        best = minloc(r%enriched, 1)
        text = text//nl//right(name, 12)//right(fixed(r%dual, 6), 12)//right(fixed(r%enriched(best), 6), 12)// &
               right(to_text(r%eta(best)/epsilon_0, 4), 12)// &
               right(first_eta(r%enriched < 1), 17)//right(first_eta(r%enriched < r%dual), 19)// &
               right(last_eta(r%enriched < r%dual), 12)
      end associate
    end do
  contains
    !> The least eta of some, and the largest.
    function first_eta(is_one) result(word)
      logical, intent(in) :: is_one(:)
      character(len=:), allocatable :: word

      word = 'none'
      if (any(is_one)) word = to_text(radii(i)%eta(findloc(is_one, .true., 1))/epsilon_0, 4)
    end function first_eta

    function last_eta(is_one) result(word)
      logical, intent(in) :: is_one(:)
      character(len=:), allocatable :: word

      word = 'none'
      if (any(is_one)) word = to_text(radii(i)%eta(findloc(is_one, .true., 1, back=.true.))/epsilon_0, 4)
    end function last_eta
  end function spectral_table

  !> One row per epsilon and eta, both over the mean diagonal term of W.
  function spectral_csv(radii, epsilon_0) result(text)
    type(spectral_radii_t), intent(in) :: radii(:) !! radii for some epsilons
    real(wp), intent(in) :: epsilon_0 !! mean diagonal term of W [1/kg]
    character(len=:), allocatable :: text
    integer :: i, j

    text = 'epsilon,eta,dual,enriched'//nl
    do i = 1, size(radii)
      do j = 1, size(radii(i)%eta)
        text = text//cell(radii(i)%epsilon/epsilon_0)//','//cell(radii(i)%eta(j)/epsilon_0)//','//cell(radii(i)%dual)//','// &
               cell(radii(i)%enriched(j))//nl
      end do
    end do
  end function spectral_csv
end module sg_spectral_text
