!> radial_distribution.csv and structure_factor.csv: the structure of the packing at some steps of a run (doc/guide/results.md).
module sg_structure_file
  use sg_error, only: error_t
  use sg_kinds, only: wp
  use sg_radial_distribution, only: radial_distribution_t
  use sg_structure_factor, only: structure_factor_t
  use sg_text, only: to_text
  use sg_text_files, only: replace_file
  implicit none
  private
  public :: structure_file_t

  character(len=*), parameter :: nl = new_line('a')

  !> Both files, as they stand
  type :: structure_file_t
    !> Last step in them, -1 for none
    integer :: step = -1
    character(len=:), allocatable, private :: radial, factor
  contains
    procedure :: add => file_add
    procedure :: write => file_write
  end type structure_file_t

contains

  !> Add the rows of a step.
  subroutine file_add(self, step, time, diameter, distribution, factor)
    class(structure_file_t), intent(inout) :: self
    integer, intent(in) :: step !! number of the step
    real(wp), intent(in) :: time !! [s]
    real(wp), intent(in) :: diameter !! mean of the grains [m]
    type(radial_distribution_t), intent(in) :: distribution !! its g(r)
    type(structure_factor_t), intent(in) :: factor !! its S(k)
    character(len=:), allocatable :: head, rows
    integer :: i

    if (.not. allocated(self%radial)) then
      self%radial = 'step,time_s,r_m,r_diameters,g'//nl
      self%factor = 'step,time_s,k_per_m,k_diameters,s,waves'//nl
    end if
    self%step = step
    head = to_text(step)//','//to_text(time)
    rows = ''
    do i = 1, distribution%n
      rows = rows//head//','//to_text(distribution%r(i))//','//to_text(distribution%r(i)/diameter)//','// &
             to_text(distribution%g(i))//nl
    end do
    self%radial = self%radial//rows
    rows = ''
    do i = 1, factor%n
      rows = rows//head//','//to_text(factor%k(i))//','//to_text(factor%k(i)*diameter)//','//to_text(factor%s(i))//','// &
             to_text(nint(factor%waves(i)))//nl
    end do
    self%factor = self%factor//rows
  end subroutine file_add

  !> Write both files.
  subroutine file_write(self, folder, error)
    class(structure_file_t), intent(in) :: self
    character(len=*), intent(in) :: folder !! folder of the results
    type(error_t), allocatable, intent(out) :: error !! set when one cannot be written

    if (.not. allocated(self%radial)) return
    call replace_file(folder//'/radial_distribution.csv', self%radial, error)
    if (.not. allocated(error)) call replace_file(folder//'/structure_factor.csv', self%factor, error)
  end subroutine file_write
end module sg_structure_file
