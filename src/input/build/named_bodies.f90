!> Names of bodies: all ranks hold all of them while a deck is read, whichever rank keeps the bodies.
module sg_named_bodies
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_kinds, only: wp, i4, i8
  use sg_local_numbers, only: local_body
  use sg_masonry, only: name_of_brick
  use sg_scene, only: scene_t
  use sg_sorting, only: sort_permutation
  use sg_text, only: text_t, to_text
  use sg_walls_from_deck, only: name_of_plane
  implicit none
  private
  public :: list_names, check_names, give_names, number_named, name_of

contains

  !> List the names that blocks give to bodies.
  subroutine list_names(deck, period, diagnostics)
    type(deck_t), intent(inout) :: deck !! checked deck; its blocks hold their bodies
    real(wp), intent(in) :: period(2) !! periods in x and y [m], zero where there is none
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(text_t), allocatable :: names(:)
    integer, allocatable :: named(:)
    character(len=:), allocatable :: name
    integer :: b, i, n

    allocate (names(max(0, maxval(deck%blocks(:deck%n)%last_body) - deck%folder_bodies)), named(size(names)))
    n = 0
    do b = 1, deck%n
      do i = deck%blocks(b)%first_body, merge(deck%blocks(b)%last_body, -1, deck%blocks(b)%first_body > 0)
        name = name_within(deck, b, i - deck%blocks(b)%first_body + 1, period)
        if (name == '') cycle
        if (name(1:1) == '#') call deck%complain(diagnostics, 'the name of a body cannot begin with #', b, 'name')
        n = n + 1
        named(n) = i
        names(n)%s = name
      end do
    end do
    block
      integer(i4), allocatable :: order(:)

      order = sort_permutation(int(named(:n), i8))
      deck%named = named(order)
      allocate (deck%names(n))
      do i = 1, n
        call move_alloc(names(order(i))%s, deck%names(i)%s)
      end do
    end block
  end subroutine list_names

  !> Name of a body of a block; empty where it has none.
  function name_within(deck, b, body, period) result(name)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, body
    real(wp), intent(in) :: period(2)
    character(len=:), allocatable :: name

    name = deck%word(b, 'name')
    if (deck%is_in(b, 'container')) name = name_of_plane(deck, b, period, body)
    if (deck%is_in(b, 'brick_wall')) name = name_of_brick(deck, b, body)
    if (deck%is_in(b, 'arch') .or. deck%is_in(b, 'chain')) name = name//'.'//to_text(body)
  end function name_within

  !> Look for bodies of the same name: sorted by a hash of their names, they are neighbours.
  subroutine check_names(deck, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck with its names
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    integer(i8), parameter :: modulus = 2_i8**50 - 27
    integer(i8) :: keys(size(deck%names))
    integer(i4), allocatable :: order(:)
    integer :: i, k, b

    keys = 0
    do i = 1, size(keys)
      do k = 1, len(deck%names(i)%s)
        keys(i) = modulo(keys(i)*257 + int(iachar(deck%names(i)%s(k:k)), i8), modulus)
      end do
    end do
    order = sort_permutation(keys)
    do i = 2, size(order)
      associate (name => deck%names(order(i))%s)
        if (name /= deck%names(order(i - 1))%s) cycle
        b = deck%block_of_body(deck%named(order(i)))
        call deck%complain(diagnostics, 'there are two bodies named "'//name//'"', b, 'name')
      end associate
    end do
  end subroutine check_names

  !> Number of the body that has a name; 0 when there is none.
  pure integer function number_named(deck, name) result(number)
    type(deck_t), intent(in) :: deck !! deck with its names
    character(len=*), intent(in) :: name !! name to look for
    integer :: i

    number = 0
    if (.not. allocated(deck%names)) return
    do i = 1, size(deck%names)
      if (deck%names(i)%s /= name) cycle
      number = deck%named(i)
      return
    end do
  end function number_named

  !> A body for messages: its name, or its number.
  function name_of(deck, number) result(name)
    type(deck_t), intent(in) :: deck !! deck with its names
    integer, intent(in) :: number !! number of the body
    character(len=:), allocatable :: name
    integer :: i

    name = 'body '//to_text(number)
    if (.not. allocated(deck%names)) return
    i = findloc(deck%named, number, 1)
    if (i > 0) name = '"'//deck%names(i)%s//'"'
  end function name_of

  !> Give the bodies of a scene their names, if any body of the deck has one.
  subroutine give_names(deck, scene)
    type(deck_t), intent(in) :: deck !! deck with its names
    type(scene_t), intent(inout) :: scene !! scene with its bodies
    integer :: b, i

    if (size(deck%names) == 0) return
    allocate (scene%names(scene%bodies%n))
    do b = 1, scene%bodies%n
      scene%names(b)%s = ''
    end do
    do i = 1, size(deck%names)
      b = local_body(scene%bodies, int(deck%named(i), i4))
      if (b > 0) scene%names(b)%s = deck%names(i)%s
    end do
  end subroutine give_names
end module sg_named_bodies
