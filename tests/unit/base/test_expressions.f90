!> Expressions: values, precedence, numbers that are none, and mistakes with their places.
program test_expressions
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use harness, only: tests_t
  use sg_expression_parser, only: parse_expression
  use sg_expressions, only: expression_t
  use sg_kinds, only: wp, pi
  use sg_text, only: append_word, text_t
  implicit none
  ! Rounding of a few operations.
  real(wp), parameter :: rounding = 1e-14_wp
  type(text_t), allocatable :: names(:)
  real(wp), parameter :: values(4) = [0.3_wp, -2.0_wp, 0.5_wp, 1e-5_wp]
  type(tests_t) :: t

  call append_word(names, 't')
  call append_word(names, 'strain_yy')
  call append_word(names, 'displacement(box.left)')
  call append_word(names, 'max_velocity')
  call test_values()
  call test_conditions()
  call test_none()
  call test_mistakes()
  call test_long()
  ! Variables of main programs stay to the end, where a leak checker would count them.
  deallocate (names)
  call t%finish()

contains

  !> Value of a text that is right.
  real(wp) function value_of(text) result(value)
    character(len=*), intent(in) :: text
    type(expression_t) :: expression
    character(len=:), allocatable :: mistake
    integer :: column

    value = huge(value)
    call parse_expression(text, names, expression, mistake, column)
    call t%check(.not. allocated(mistake), text//' is right')
    if (allocated(mistake)) return
    value = expression%at(values)
    call t%check(expression%text == text, text//' is kept')
  end function value_of

  subroutine near(text, expected)
    character(len=*), intent(in) :: text
    real(wp), intent(in) :: expected

    call t%near(value_of(text), expected, rounding*max(1.0_wp, abs(expected)), text)
  end subroutine near

  !> What arithmetic says.
  subroutine test_values()
    call near('1', 1.0_wp)
    call near(' 1.5e2+ .5 ', 150.5_wp)
    call near('4e-3*2*pi*35*cos(2*pi*35*t) - 0.1', 4e-3_wp*2*pi*35*cos(2*pi*35*0.3_wp) - 0.1_wp)
    call near('2+3*4', 14.0_wp)
    call near('(2+3)*4', 20.0_wp)
    call near('2-3-4', -5.0_wp)
    call near('24/4/3', 2.0_wp)
    call near('-2^2', -4.0_wp)
    call near('2^3^2', 512.0_wp)
    call near('2**-1', 0.5_wp)
    call near('(-2)**3', -8.0_wp)
    call near('4^0.5', 2.0_wp)
    call near('0^0 + 0^2', 1.0_wp)
    call near('--3 - +2', 1.0_wp)
    call near('strain_yy*displacement(box.left)', -1.0_wp)
    call near('sin(1)+cos(1)+tan(1)', sin(1.0_wp) + cos(1.0_wp) + tan(1.0_wp))
    call near('asin(0.5)+acos(0.5)+atan(0.5)+atan2(1,-1)', pi/2 + atan(0.5_wp) + 0.75_wp*pi)
    call near('sinh(1)+cosh(1)+tanh(1)', sinh(1.0_wp) + cosh(1.0_wp) + tanh(1.0_wp))
    call near('exp(1)+log(2)+log10(1000)+sqrt(2)', exp(1.0_wp) + log(2.0_wp) + 3 + sqrt(2.0_wp))
    call near('abs(-2)+floor(-1.5)+floor(2.5)+min(1, 2)+max(1, 2)', 2.0_wp - 2 + 2 + 1 + 2)
    call near('mod(-1, 3) + mod(7.5, 2)', 2 + 1.5_wp)
    call near('if(t < 0.5, 10, 20) + if(t > 0.5, 1, 2)', 12.0_wp)
    call near('(t >= 0.1)*(t < 0.4)*7', 7.0_wp)
  end subroutine test_values

  subroutine test_conditions()
    type(expression_t) :: expression
    character(len=:), allocatable :: mistake
    integer :: column

    call near('max_velocity < 1e-4', 1.0_wp)
    call near('max_velocity < 1e-4 and not t < 0.2', 1.0_wp)
    call near('t > 1 or t <= 0.3 and strain_yy >= -2', 1.0_wp)
    call near('(t > 1 or t <= 0.3) and strain_yy > -2', 0.0_wp)
    call near('not not 3', 1.0_wp)
    call parse_expression('t < 1', names, expression, mistake, column)
    call t%check(expression%is_condition, 'a comparison is a condition')
    call parse_expression('(t < 1)*2', names, expression, mistake, column)
    call t%check(.not. expression%is_condition, 'a product is none')
  end subroutine test_conditions

  !> What has no value is a NaN, and no comparison with it holds or fails.
  subroutine test_none()
    character(len=20), parameter :: texts(13) = [character(len=20) :: '1/0', 'sqrt(-1)', 'log(0)', 'asin(2)', '(-2)^0.5', &
      '0^-1', '10^400', '1e40^8*1e40', 'exp(1000)', 'cosh(1000)', 'mod(1, 0)', '1/0 < 1', '1e49^6*1e10+1']
    integer :: i

    do i = 1, size(texts)
      call t%check(ieee_is_nan(value_of(trim(texts(i)))), trim(texts(i))//' is none')
    end do
    call near('exp(-1000)', exp(-690.0_wp))
    call near('if(t > 0, 1, 1/0)', 1.0_wp)
  end subroutine test_none

  subroutine mistake_at(text, place, words)
    character(len=*), intent(in) :: text, words
    integer, intent(in) :: place
    type(expression_t) :: expression
    character(len=:), allocatable :: mistake
    integer :: column

    call parse_expression(text, names, expression, mistake, column)
    call t%check(allocated(mistake), text//' is wrong')
    if (.not. allocated(mistake)) return
    call t%equal(column, place, text//': place')
    call t%check(index(mistake, words) > 0, text//': '//mistake)
  end subroutine mistake_at

  subroutine test_mistakes()
    call mistake_at('', 1, 'ends where a number')
    call mistake_at('1 +', 3, 'ends where a number')
    call mistake_at('1 2', 3, 'an operation should stand here')
    call mistake_at('2*(3+4', 6, 'a closing bracket')
    call mistake_at('2)', 2, 'an operation should stand here')
    call mistake_at('1.2.3', 1, '"1.2.3" is no number')
    call mistake_at('3 * 1e', 5, '"1e" is no number')
    call mistake_at('1e99', 1, 'is no number')
    call mistake_at('2 * strain_y', 5, 'there is no "strain_y" here; did you mean "strain_yy"?')
    call mistake_at('displacement(box.lef) > 1', 1, 'did you mean "displacement(box.left)"?')
    call mistake_at('2 + cis(t)', 5, 'there is no "cis(t)" here')
    call mistake_at('cos t', 5, 'the function cos needs brackets')
    call mistake_at('atan2(1)', 8, 'takes 2 numbers')
    call mistake_at('sin(1, 2)', 6, 'a closing bracket')
    call mistake_at('1 < t < 2', 7, 'join two by "and"')
    call mistake_at('t == 1', 3, 'an operation should stand here')
    call mistake_at('#', 1, 'a number or a name')
    call mistake_at('t; 1', 2, 'an operation should stand here')
  end subroutine test_mistakes

  !> Neither brackets nor letters without end.
  subroutine test_long()
    call near(repeat('(', 40)//'t'//repeat(')', 40), 0.3_wp)
    call mistake_at(repeat('(', 60)//'t'//repeat(')', 60), 52, 'brackets within each other')
    call mistake_at(repeat('-', 60)//'t', 52, 'brackets within each other')
    call mistake_at(repeat('t+', 1100)//'t', 1, 'at most 2000 letters')
    call t%near(value_of(repeat('t+', 900)//'0'), 270.0_wp, 900*270*rounding, 'nine hundred terms')
  end subroutine test_long
end program test_expressions
