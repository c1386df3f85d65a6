!> Means over each subdomain: stress of its grains, fabric, compactness, velocity gradient, one row per subdomain and recorded step
!! (doc/guide/regions.md).
!!
!! A grain belongs to the subdomain of its owner, a contact to the one that solves it. Each rank measures its own share by the
!! formulas of the record, and one sum over ranks hands all rows to all of them. No value outlives the step.
module sg_subdomain_means
  use sg_comm, only: comm_t
  use sg_compactness, only: measure_compactness
  use sg_contacts, only: contacts_t
  use sg_fabric, only: measure_fabric, n_fabric_sums
  use sg_grains, only: grains_of, grains_t, sum_grains
  use sg_inertia_number, only: field_sums, gradient_of, n_field_sums
  use sg_kinds, only: wp
  use sg_scene, only: scene_t
  use sg_stress, only: stress_sums
  use sg_tally, only: pass_columns, pass_sums, ratio, tally_t
  implicit none
  private
  public :: subdomain_means_t, subdomain_columns, n_subdomain_counts

  !> Columns that hold whole numbers: grains and contacts
  integer, parameter :: n_subdomain_counts = 2

  !> The means of all subdomains
  type :: subdomain_means_t
    !> Are they asked for?
    logical :: is_on = .false.
    !> Columns of the last rows, shape (columns, subdomains), the same on all ranks
    real(wp), allocatable :: value(:, :)
  contains
    procedure :: measure => subdomain_means_measure
  end type subdomain_means_t

contains

  !> Names of the columns that follow step, time and subdomain in subdomains.csv. The first ones are counts (`n_subdomain_counts`).
  pure function subdomain_columns(dimension) result(names)
    integer, intent(in) :: dimension !! of space
    character(len=32), allocatable :: names(:)
    type(scene_t) :: scene
    type(contacts_t) :: contacts
    type(tally_t) :: tally
    integer :: i

    scene%dimension = dimension
    scene%bodies%dimension = dimension
    tally%pass = pass_columns
    call add_columns(scene, contacts, tally)
    allocate (names(size(tally%column)))
    do i = 1, size(names)
      names(i) = tally%column(i)%name
    end do
  end function subdomain_columns

  !> Measure all subdomains after the update of a step. Collective: all ranks get the same values.
  subroutine subdomain_means_measure(self, scene, contacts, h, comm)
    class(subdomain_means_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene !! scene after the update, corners of all shapes placed
    type(contacts_t), intent(in) :: contacts !! contacts with the impulses of the step
    real(wp), intent(in) :: h !! time step [s]
    type(comm_t), intent(inout) :: comm !! the ranks
    type(tally_t) :: tally
    type(comm_t) :: alone
    real(wp), allocatable :: values(:)
    integer :: n, i

    tally%h = h
    do while (tally%pass <= pass_columns)
      call add_columns(scene, contacts, tally)
      call tally%reduce(alone)
    end do
    n = size(tally%column)
    allocate (values(n*comm%size), source=0.0_wp)
    do i = 1, n
      values(n*comm%rank + i) = tally%column(i)%value
    end do
    if (comm%size > 1) call comm%sum(values)
    self%value = reshape(values, [n, comm%size])
  end subroutine subdomain_means_measure

  !> THE list of columns of a subdomain, visited as the indicators of the record are (sg_measures).
  pure subroutine add_columns(scene, contacts, tally)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    type(tally_t), intent(inout) :: tally

    call sum_grains(scene%bodies, tally)
    if (tally%pass == pass_columns) call add_counts(tally)
    call measure_compactness(scene, tally)
    call add_stress(scene, contacts, tally)
    call measure_fabric(scene, contacts, tally)
    call add_gradient(scene, tally)
  end subroutine add_columns

  !> Numbers of grains, and of contacts between grains that carry a positive normal impulse.
  pure subroutine add_counts(tally)
    type(tally_t), intent(inout) :: tally
    type(grains_t) :: grains
    real(wp) :: carrying(n_fabric_sums)

    grains = grains_of(tally)
    carrying = tally%sums%get('fabric', n_fabric_sums)
    call tally%add('grains', real(grains%n, wp), is_count=.true.)
    call tally%add('contacts', carrying(1), is_count=.true.)
  end subroutine add_counts

  !> Stress of the grains [Pa]: sum of force (x) branch over their own volume, so that it needs no box.
  pure subroutine add_stress(scene, contacts, tally)
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    type(tally_t), intent(inout) :: tally
    type(grains_t) :: grains
    real(wp) :: stress(scene%dimension**2)
    integer :: i

    if (tally%pass == pass_sums) call tally%sums%put('stress', reshape(stress_sums(scene, contacts), [scene%dimension**2]))
    if (tally%pass /= pass_columns) return
    grains = grains_of(tally)
    stress = tally%sums%get('stress', size(stress))
    call add_tensor('grain_stress_', [(ratio(stress(i), grains%area*tally%h), i=1, size(stress))], tally)
  end subroutine add_stress

  !> Gradient of the affine velocity field nearest to the velocities of the grains [1/s]; the second axis is that of the derivative.
  pure subroutine add_gradient(scene, tally)
    type(scene_t), intent(in) :: scene
    type(tally_t), intent(inout) :: tally
    real(wp) :: gradient(scene%dimension, scene%dimension)

    if (tally%pass == pass_sums) call tally%sums%put('field', field_sums(scene%bodies))
    if (tally%pass /= pass_columns) return
    gradient = gradient_of(tally%sums%get('field', n_field_sums(scene%dimension)), scene%dimension)
    call add_tensor('velocity_gradient_', reshape(gradient, [size(gradient)]), tally)
  end subroutine add_gradient

  !> Add the components of a tensor, row by row.
  pure subroutine add_tensor(prefix, tensor, tally)
    character(len=*), intent(in) :: prefix !! of the names
    real(wp), intent(in) :: tensor(:) !! column by column
    type(tally_t), intent(inout) :: tally
    character(len=*), parameter :: axis = 'xyz'
    integer :: a, b, d

    d = nint(sqrt(real(size(tensor), wp)))
    do a = 1, d
      do b = 1, d
        call tally%add(prefix//axis(a:a)//axis(b:b), tensor(a + d*(b - 1)))
      end do
    end do
  end subroutine add_tensor
end module sg_subdomain_means
