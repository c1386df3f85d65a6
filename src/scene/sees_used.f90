!> What each line of the see tables does in a scene, and which shapes no line brings together with any other: what is left out by
!! mistake leaves bodies without contacts.
module sg_sees_used
  use sg_contactors, only: n_kinds
  use sg_scene, only: scene_t, see_t
  use sg_sees, only: links_points
  use sg_shape_pairs, only: can_touch
  implicit none
  private
  public :: see_uses_t, find_uses, is_used, fits_nothing, fits_blind, is_spare

  !> What a line of the see tables does: it holds between some shapes; no two shapes of different bodies fit it; those that do
  !! cannot touch each other; or all of them have earlier lines, each a special case of this one, which is for what those leave.
  !! A positive number is an earlier line that hides it.
  integer, parameter :: is_used = 0, fits_nothing = -1, fits_blind = -2, is_spare = -3
  !> Looks beyond which nothing is looked for: the table of their pairs grows with the square
  integer, parameter :: most_looks = 2000

  !> What see tables do
  type :: see_uses_t
    !> Of each line: `is_used`, `fits_nothing`, `fits_blind`, `is_spare` or the line that hides it, shape (lines)
    integer, allocatable :: line(:)
    !> Kind and colour of shapes of grains that no line brings together with any other, although some could touch, shape (2, any)
    integer, allocatable :: alone(:, :)
  end type see_uses_t

contains

  !> Find what the see tables of a scene do.
  pure subroutine find_uses(scene, others, uses)
    type(scene_t), intent(in) :: scene !! scene with its see tables
    integer, allocatable, intent(in) :: others(:, :) !! kinds and colours of grains that other ranks keep, with the first and the
    !! last body of each, shape (4, any); perhaps unallocated
    type(see_uses_t), intent(out) :: uses !! what they do
    integer, allocatable :: looks(:, :), holder(:, :)
    integer :: line

    call list_looks(scene, others, looks)
    allocate (uses%line(size(scene%sees)), source=is_used)
    allocate (uses%alone(2, 0))
    if (size(looks, 2) > most_looks) return
    allocate (holder(size(looks, 2), size(looks, 2)), source=0)
    do line = 1, size(scene%sees)
      associate (see => scene%sees(line))
        call hold(scene%sees, line, looks, fitting(looks, see%candidate_kind, see%candidate_colour), &
                  fitting(looks, see%antagonist_kind, see%antagonist_colour), holder, uses%line(line))
      end associate
    end do
    uses%alone = looks(:2, lonely(looks, holder))
  end subroutine find_uses

  !> Give a line the pairs of looks that fit it and that no earlier line has.
  pure subroutine hold(sees, line, looks, candidates, antagonists, holder, use)
    type(see_t), intent(in) :: sees(:)
    integer, intent(in) :: line, looks(:, :), candidates(:), antagonists(:)
    integer, intent(inout) :: holder(:, :)
    integer, intent(out) :: use
    integer :: i, j

    use = fits_nothing
    do i = 1, size(candidates)
      do j = 1, size(antagonists)
        associate (one => candidates(i), other => antagonists(j))
          if (are_of_one_body(looks(:, one), looks(:, other))) cycle
          if (links_points(sees(line))) then
            use = is_used
          else if (.not. can_touch(looks(1, one), looks(1, other))) then
            if (use == fits_nothing) use = fits_blind
          else if (holder(one, other) == 0) then
            holder(one, other) = line
            holder(other, one) = line
            use = is_used
          else if (use < is_used) then
            use = holder(one, other)
            if (is_special_case(sees(use), sees(line))) use = is_spare
          end if
        end associate
      end do
    end do
  end subroutine hold

  !> Does a line fit but part of what another one fits?
  pure logical function is_special_case(see, general)
    type(see_t), intent(in) :: see, general
    integer :: special_words(4), words(4)

    special_words = [see%candidate_kind, see%candidate_colour, see%antagonist_kind, see%antagonist_colour]
    words = [general%candidate_kind, general%candidate_colour, general%antagonist_kind, general%antagonist_colour]
    is_special_case = (all(words == 0 .or. words == special_words) .or. &
                       all(words == 0 .or. words == special_words([3, 4, 1, 2]))) .and. &
                      count(words == 0) > count(special_words == 0)
  end function is_special_case

  !> Looks of grains, by index, that no line brings together with any other, although some could touch them.
  pure function lonely(looks, holder) result(list)
    integer, intent(in) :: looks(:, :), holder(:, :)
    integer, allocatable :: list(:)
    logical :: is_lonely(size(looks, 2))
    integer :: i, j

    is_lonely = .false.
    do i = 1, size(looks, 2)
      if (looks(5, i) == 0 .or. any(holder(:, i) > 0)) cycle
      is_lonely(i) = any([(can_touch(looks(1, i), looks(1, j)) .and. .not. are_of_one_body(looks(:, i), looks(:, j)), &
                           j=1, size(looks, 2))])
    end do
    list = pack([(i, i=1, size(looks, 2))], is_lonely)
  end function lonely

  !> Do two looks belong to one and the same body alone, whose shapes never touch each other?
  pure logical function are_of_one_body(one, other)
    integer, intent(in) :: one(:), other(:)

    are_of_one_body = all([one(3:4), other(3:4)] == one(3))
  end function are_of_one_body

  !> Looks, by index, that fit one side of a line.
  pure function fitting(looks, kind, colour) result(list)
    integer, intent(in) :: looks(:, :), kind, colour
    integer, allocatable :: list(:)
    integer :: i

    list = pack([(i, i=1, size(looks, 2))], (kind == 0 .or. looks(1, :) == kind) .and. (colour == 0 .or. looks(2, :) == colour))
  end function fitting

  !> Kinds and colours of all shapes, with the first and the last body of each, and is any of them a grain (1 or 0).
  pure subroutine list_looks(scene, others, looks)
    type(scene_t), intent(in) :: scene
    integer, allocatable, intent(in) :: others(:, :)
    integer, allocatable, intent(out) :: looks(:, :)
    integer, allocatable :: table(:, :, :)
    integer :: i, kind, colour, n, body, number

    n = 0
    if (allocated(scene%colours)) n = size(scene%colours)
    allocate (table(3, n_kinds, n), source=0)
    table(1, :, :) = huge(1)
    do i = 1, scene%contactors%n
      body = scene%contactors%body(i)
      number = body
      if (allocated(scene%bodies%id)) number = scene%bodies%id(body)
      call note(table(:, scene%contactors%kind(i), scene%contactors%colour(i)), [number, number], scene%bodies%is_grain(body))
    end do
    if (allocated(others)) then
      do i = 1, size(others, 2)
        call note(table(:, others(1, i), others(2, i)), others(3:4, i), .true.)
      end do
    end if
    allocate (looks(5, count(table(2, :, :) > 0)))
    i = 0
    do colour = 1, n
      do kind = 1, n_kinds
        if (table(2, kind, colour) == 0) cycle
        i = i + 1
        looks(:, i) = [kind, colour, table(:, kind, colour)]
      end do
    end do
  end subroutine list_looks

  !> Note bodies of a look.
  pure subroutine note(look, bodies, is_grain)
    integer, intent(inout) :: look(3)
    integer, intent(in) :: bodies(2)
    logical, intent(in) :: is_grain

    look = [min(look(1), bodies(1)), max(look(2), bodies(2)), max(look(3), merge(1, 0, is_grain))]
  end subroutine note
end module sg_sees_used
