!> Patterns of names: `*` stands for any letters or none, `?` for any one letter.
module sg_wildcards
  implicit none
  private
  public :: has_wildcard, matches

contains

  !> Does a word hold a wildcard?
  pure logical function has_wildcard(word)
    character(len=*), intent(in) :: word !! name or pattern

    has_wildcard = scan(word, '*?') > 0
  end function has_wildcard

  !> Does a name match a pattern? Letters stand for themselves; where a `*` took too few letters, it takes one more.
  pure logical function matches(name, pattern)
    character(len=*), intent(in) :: name !! the name
    character(len=*), intent(in) :: pattern !! with wildcards or without
    integer :: i, p, star, taken

    i = 1
    p = 1
    star = 0
    taken = 0
    do while (i <= len(name))
      if (fits(pattern, p, name(i:i))) then
        i = i + 1
        p = p + 1
      else if (is_star(pattern, p)) then
        star = p
        taken = i
        p = p + 1
      else if (star > 0) then
        taken = taken + 1
        i = taken
        p = star + 1
      else
        matches = .false.
        return
      end if
    end do
    do while (is_star(pattern, p))
      p = p + 1
    end do
    matches = p > len(pattern)
  end function matches

  !> Does the letter at a place of a pattern stand for another one? A star does not.
  pure logical function fits(pattern, place, letter)
    character(len=*), intent(in) :: pattern
    integer, intent(in) :: place
    character, intent(in) :: letter

    fits = .false.
    if (place > len(pattern)) return
    if (pattern(place:place) == '*') return
    fits = pattern(place:place) == '?' .or. pattern(place:place) == letter
  end function fits

  !> Is there a star at a place of a pattern?
  pure logical function is_star(pattern, place)
    character(len=*), intent(in) :: pattern
    integer, intent(in) :: place

    is_star = .false.
    if (place <= len(pattern)) is_star = pattern(place:place) == '*'
  end function is_star
end module sg_wildcards
