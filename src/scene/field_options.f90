!> A coarse-grained field as a deck asks for it (doc/guide/fields.md).
module sg_field_options
  use sg_kinds, only: wp
  implicit none
  private
  public :: field_options_t, kernel_names, kernel_gaussian, kernel_box, most_fields

  !> Kernels, and their words
  integer, parameter :: kernel_gaussian = 1, kernel_box = 2
  character(len=8), parameter :: kernel_names(2) = [character(len=8) :: 'gaussian', 'box']
  !> Fields of a run at most: their files have fixed names
  integer, parameter :: most_fields = 4

  !> One field
  type :: field_options_t
    !> Least and largest coordinates of the box [m]; in the plane from 0 to 1 along z
    real(wp) :: lower(3) = 0, upper(3) = 1
    !> Cells along each axis
    integer :: cells(3) = 1
    !> Kernel, and its width: standard deviation, or half side [m]
    integer :: kernel = kernel_gaussian
    real(wp) :: width = 0
    !> Steps between two grids in the file, and between two samples that a grid is the mean of; 0 for one sample
    integer :: every = 0, sample_every = 0
  end type field_options_t
end module sg_field_options
