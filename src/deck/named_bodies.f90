!> Names of bodies.
module sg_named_bodies
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: i4, i8
  use sg_scene, only: scene_t
  use sg_sorting, only: sort_permutation
  implicit none
  private
  public :: name_body, give_name, check_names

contains

  !> Note the name that a block gives to a body.
  subroutine name_body(deck, b, scene, n, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: b !! block of the body
    type(scene_t), intent(inout) :: scene !! scene with room for its bodies
    integer, intent(in) :: n !! number of the body
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    character(len=:), allocatable :: name

    name = deck%word(b, 'name')
    if (name == '') return
    if (name(1:1) == '#') call deck%complain(diagnostics, 'the name of a body cannot begin with #', b, 'name')
    call give_name(scene, n, name)
  end subroutine name_body

  !> Name a body.
  subroutine give_name(scene, n, name)
    type(scene_t), intent(inout) :: scene !! scene with room for its bodies
    integer, intent(in) :: n !! number of the body
    character(len=*), intent(in) :: name !! its name
    integer :: i

    if (.not. allocated(scene%names)) then
      allocate (scene%names(scene%bodies%n))
      do i = 1, size(scene%names)
        scene%names(i)%s = ''
      end do
    end if
    scene%names(n)%s = name
  end subroutine give_name

  !> Look for bodies of the same name: sorted by a hash of their names, they are neighbours.
  subroutine check_names(deck, scene, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck; its blocks know their bodies
    type(scene_t), intent(in) :: scene !! scene with its names
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer(i8), parameter :: modulus = 2_i8**50 - 27
    integer(i8), allocatable :: keys(:)
    integer(i4), allocatable :: order(:)
    integer :: i, k, b

    if (.not. allocated(scene%names)) return
    allocate (keys(size(scene%names)), source=0_i8)
    do i = 1, size(keys)
      do k = 1, len(scene%names(i)%s)
        keys(i) = modulo(keys(i)*257 + int(iachar(scene%names(i)%s(k:k)), i8), modulus)
      end do
    end do
    order = sort_permutation(keys)
    do i = 2, size(order)
      associate (name => scene%names(order(i))%s)
        if (name == '' .or. name /= scene%names(order(i - 1))%s) cycle
        b = deck%block_of_body(int(order(i)))
        call deck%complain(diagnostics, 'there are two bodies named "'//name//'"', b, 'name')
      end associate
    end do
  end subroutine check_names
end module sg_named_bodies
