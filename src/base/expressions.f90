!> Expressions of named variables, as decks write them: `4e-3*2*pi*35*cos(2*pi*35*t) - 0.1`, `max_velocity < 1e-4 and time > 0.5`.
!!
!! A text is translated once into instructions for a stack of numbers (sg_expression_parser), which `at` carries out. Nothing but
!! arithmetic can be written. A value that is none (1/0, sqrt(-1), beyond 10^300) is a NaN and makes all that it enters one, without
!! a floating-point exception.
module sg_expressions
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
  use sg_kinds, only: wp
  implicit none
  private
  public :: expression_t, function_t, functions
  public :: do_number, do_variable, do_negate, do_not, do_add, do_subtract, do_multiply, do_divide, do_power, do_less, do_at_most, &
            do_greater, do_at_least, do_and, do_or, do_function

  !> Instructions: put a number or a variable on the stack; replace one number; replace two; from `do_function` on, functions
  integer, parameter :: do_number = 1, do_variable = 2, do_negate = 3, do_not = 4, do_add = 5, do_subtract = 6, do_multiply = 7, &
                        do_divide = 8, do_power = 9, do_less = 10, do_at_most = 11, do_greater = 12, do_at_least = 13, &
                        do_and = 14, do_or = 15, do_function = 100

  !> A function: its name, and how many numbers it takes
  type :: function_t
    character(len=5) :: name = ''
    integer :: arguments = 1
  end type function_t

  !> All functions; the instruction of each is `do_function` and its place
  type(function_t), parameter :: functions(20) = [function_t('sin  '), function_t('cos  '), function_t('tan  '), &
    function_t('asin '), function_t('acos '), function_t('atan '), function_t('sinh '), function_t('cosh '), function_t('tanh '), &
    function_t('exp  '), function_t('log  '), function_t('log10'), function_t('sqrt '), function_t('abs  '), function_t('floor'), &
    function_t('min  ', 2), function_t('max  ', 2), function_t('atan2', 2), function_t('mod  ', 2), function_t('if   ', 3)]

  !> Sizes up to which sums, and powers by their logarithms, cannot overflow
  real(wp), parameter :: largest = 1e300_wp, largest_logarithm = 690.0_wp

  !> An expression
  type :: expression_t
    !> As it was written
    character(len=:), allocatable :: text
    !> Instructions, and for each the number or the index of the variable that it takes
    integer, allocatable :: instruction(:)
    real(wp), allocatable :: operand(:)
    !> Numbers on the stack at most
    integer :: depth = 0
    !> Is its value true (1) or false (0)?
    logical :: is_condition = .false.
  contains
    procedure :: at => expression_at
  end type expression_t

contains

  !> Value of an expression; a NaN where there is none.
  pure real(wp) function expression_at(self, variables) result(value)
    class(expression_t), intent(in) :: self
    real(wp), intent(in) :: variables(:) !! values, in the order of the names it was parsed with
    real(wp) :: stack(self%depth)
    integer :: i, top, n

    top = 0
    do i = 1, size(self%instruction)
      select case (self%instruction(i))
      case (do_number)
        n = 0
        stack(top + 1) = self%operand(i)
      case (do_variable)
        n = 0
        stack(top + 1) = variables(nint(self%operand(i)))
      case (do_negate, do_not)
        n = 1
      case (do_function:)
        n = functions(self%instruction(i) - do_function)%arguments
      case default
        n = 2
      end select
      if (n > 0) stack(top - n + 1) = applied(self%instruction(i), stack(top - n + 1:top))
      top = top - n + 1
    end do
    value = stack(1)
  end function expression_at

  !> An operation or a function of its numbers.
  pure real(wp) function applied(instruction, x) result(value)
    integer, intent(in) :: instruction
    real(wp), intent(in) :: x(:)

    value = ieee_value(1.0_wp, ieee_quiet_nan)
    if (instruction == do_function + size(functions)) then
      if (.not. ieee_is_nan(x(1))) value = merge(x(2), x(3), abs(x(1)) > 0)
      return
    end if
    if (any(ieee_is_nan(x))) return
    if (any(abs(x) > largest)) return
    if (instruction > do_function) then
      value = called(instruction - do_function, x)
    else
      value = combined(instruction, x(1), x(size(x)))
    end if
  end function applied

  !> An operation of one number, which is `a` and `b`, or of two, neither of them beyond `largest`.
  pure real(wp) function combined(instruction, a, b) result(value)
    integer, intent(in) :: instruction
    real(wp), intent(in) :: a, b

    value = ieee_value(1.0_wp, ieee_quiet_nan)
    select case (instruction)
    case (do_negate)
      value = -b
    case (do_not)
      value = truth(.not. abs(b) > 0)
    case (do_add)
      value = a + b
    case (do_subtract)
      value = a - b
    case (do_multiply)
      if (exponent(a) + exponent(b) < maxexponent(a)) value = a*b
    case (do_divide)
      if (abs(b) > 0 .and. exponent(a) - exponent(b) < maxexponent(a) - 1) value = a/b
    case (do_power)
      value = power(a, b)
    case (do_less)
      value = truth(a < b)
    case (do_at_most)
      value = truth(a <= b)
    case (do_greater)
      value = truth(a > b)
    case (do_at_least)
      value = truth(a >= b)
    case (do_and)
      value = truth(abs(a) > 0 .and. abs(b) > 0)
    case (do_or)
      value = truth(abs(a) > 0 .or. abs(b) > 0)
    end select
  end function combined

  !> A power; of a negative number for whole exponents alone.
  pure real(wp) function power(a, b) result(value)
    real(wp), intent(in) :: a, b

    value = ieee_value(1.0_wp, ieee_quiet_nan)
    if (.not. abs(a) > 0) then
      if (b >= 0) value = merge(0.0_wp, 1.0_wp, b > 0)
      return
    end if
    if (a < 0 .and. abs(b - anint(b)) > 0) return
    if (abs(b)*abs(log(abs(a))) > largest_logarithm) return
    if (abs(b - anint(b)) > 0 .or. abs(b) > 1e6_wp) then
      value = abs(a)**b
      if (a < 0 .and. abs(modulo(b, 2.0_wp)) > 0) value = -value
    else
      value = a**nint(b)
    end if
  end function power

  !> A function of its numbers.
  pure real(wp) function called(place, x) result(value)
    integer, intent(in) :: place
    real(wp), intent(in) :: x(:)

    value = ieee_value(1.0_wp, ieee_quiet_nan)
    select case (functions(place)%name)
    case ('sin')
      value = sin(x(1))
    case ('cos')
      value = cos(x(1))
    case ('tan')
      value = tan(x(1))
    case ('asin')
      if (abs(x(1)) <= 1) value = asin(x(1))
    case ('acos')
      if (abs(x(1)) <= 1) value = acos(x(1))
    case ('atan')
      value = atan(x(1))
    case ('sinh')
      if (abs(x(1)) < largest_logarithm) value = sinh(x(1))
    case ('cosh')
      if (abs(x(1)) < largest_logarithm) value = cosh(x(1))
    case ('tanh')
      value = tanh(x(1))
    case ('exp')
      if (x(1) < largest_logarithm) value = exp(max(x(1), -largest_logarithm))
    case ('log')
      if (x(1) > 0) value = log(x(1))
    case ('log10')
      if (x(1) > 0) value = log10(x(1))
    case ('sqrt')
      if (x(1) >= 0) value = sqrt(x(1))
    case ('abs')
      value = abs(x(1))
    case ('floor')
      value = aint(x(1))
      if (value > x(1)) value = value - 1
    case ('min')
      value = min(x(1), x(2))
    case ('max')
      value = max(x(1), x(2))
    case ('atan2')
      value = 0
      if (any(abs(x) > 0)) value = atan2(x(1), x(2))
    case ('mod')
      if (abs(x(2)) > 0) value = modulo(x(1), x(2))
    end select
  end function called

  !> True and false as numbers.
  pure real(wp) function truth(holds)
    logical, intent(in) :: holds

    truth = merge(1.0_wp, 0.0_wp, holds)
  end function truth
end module sg_expressions
