!> Base: text, random numbers, growing lists.
program test_base
  use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
  use harness, only: tests_t
  use sg_ascending, only: distinct, first_at_least, place_in
  use sg_error, only: diagnostics_t, error_t, fail
  use sg_kinds, only: i4, i8, wp
  use sg_lists, only: reserve
  use sg_random, only: random_t
  use sg_sorting, only: hilbert_order, sort_permutation
  use sg_text, only: lower, nearest_word, read_lines, text_t, to_text
  use sg_wildcards, only: has_wildcard, matches
  use written_files, only: put_text
  implicit none
  type(tests_t) :: t

  call test_text()
  call test_reals()
  call test_errors()
  call test_random()
  call test_recurrences()
  call test_shuffle()
  call test_lists()
  call test_ascending()
  call test_sorting()
  call test_curve()
  call test_wildcards()
  call t%finish()

contains

  subroutine test_text()
    type(text_t) :: known(3)
    type(text_t), allocatable :: lines(:)
    type(error_t), allocatable :: error

    known(1)%s = 'friction'
    known(2)%s = 'kind'
    known(3)%s = 'name'
    call t%check(nearest_word('frction', known) == 'friction', 'a letter missing')
    call t%check(nearest_word('zzzzzz', known) == '', 'nothing near')
    call t%check(lower('AbC9') == 'abc9', 'lower case')
    call t%check(to_text(0.1_wp, 3) == '1.00E-01', 'real with three digits: '//to_text(0.1_wp, 3))
    call put_text('lines.txt', 'one'//achar(13)//new_line('a')//new_line('a')//'three')
    call read_lines('lines.txt', lines, error)
    call t%check(.not. allocated(error), 'file is read')
    call t%equal(size(lines), 3, 'lines of a file without a last end')
    call t%check(lines(1)%s == 'one' .and. lines(2)%s == '' .and. lines(3)%s == 'three', 'their texts')
    call read_lines('no_such_file', lines, error)
    call t%check(allocated(error), 'a missing file is an error')
  end subroutine test_text

  !> Words of reals are those of formatted output, to the last digit, whatever the number and the digits.
  subroutine test_reals()
    type(random_t) :: random
    character(len=40) :: form, buffer
    real(wp) :: value
    integer :: i, digits, wrong

    call random%seed(29)
    wrong = 0
    do i = 1, 20000
      value = (random%uniform() - 0.5_wp)*10.0_wp**floor(600*random%uniform() - 300)
      if (modulo(i, 5) == 0) value = real(i/5, wp)/8
      digits = 2 + modulo(i, 16)
      write (form, '("(es40.", i0, "e", i0, ")")') digits - 1, merge(3, 2, abs(value) >= 9.95e99_wp .or. abs(value) < 1e-99_wp)
      if (.not. abs(value) > 0) write (form, '("(es40.", i0, "e2)")') digits - 1
      write (buffer, form) value
      if (to_text(value, digits) /= trim(adjustl(buffer))) wrong = wrong + 1
    end do
    call t%equal(wrong, 0, 'words of reals are those of formatted output')
    call t%check(to_text(0.0_wp) == '0.0000000000000000E+00', 'zero: '//to_text(0.0_wp))
    call t%check(to_text(-huge(1.0_wp)) == '-1.7976931348623157E+308', 'the least number: '//to_text(-huge(1.0_wp)))
    call t%check(to_text(ieee_value(1.0_wp, ieee_positive_inf)) == 'Infinity', 'infinity')
  end subroutine test_reals

  subroutine test_errors()
    type(error_t), allocatable :: error
    type(diagnostics_t) :: diagnostics
    character(len=*), parameter :: nl = new_line('a')

    call fail(error, 'unknown key', file='a.toml', line=12, column=3, text='  frction = 1')
    call t%check(error%report() == 'a.toml:12:3: error: unknown key'//nl//'    frction = 1'//nl//'    ^', 'line and caret')
    call diagnostics%warn('odd')
    call t%equal(diagnostics%count(), 0, 'a warning is no error')
    call diagnostics%add('bad')
    call t%equal(diagnostics%count(), 1, 'an error counts')
  end subroutine test_errors

  subroutine test_random()
    type(random_t) :: a, b
    real(wp) :: x, mean, square
    integer :: i
    integer, parameter :: n = 100000

    call a%seed(7)
    call b%seed(7)
    mean = 0
    square = 0
    do i = 1, n
      x = a%uniform()
      if (abs(x - b%uniform()) > 0) exit
      mean = mean + x/n
      square = square + x**2/n
    end do
    call t%check(i == n + 1, 'the same seed gives the same numbers')
    ! Standard deviations of these means: 0.29/sqrt(n) and 0.30/sqrt(n); five of them allowed.
    call t%near(mean, 0.5_wp, 5*0.3_wp/sqrt(real(n, wp)), 'mean')
    call t%near(square, 1/3.0_wp, 5*0.3_wp/sqrt(real(n, wp)), 'mean square')
    call b%seed(8)
    call t%check(abs(a%uniform() - b%uniform()) > 0, 'another seed gives other numbers')
  end subroutine test_random

  !> The recurrences of the generator in long integers, which are exact, from its published seed (12345 six times): its first
  !! numbers are 0.127, 0.319 and 0.309, and a hundred thousand agree bit by bit.
  subroutine test_recurrences()
    type(random_t) :: random, again
    integer(i8), parameter :: m1 = 4294967087_i8, m2 = 4294944443_i8
    integer(i8) :: s(6), p1, p2, difference
    real(wp) :: x, first(3)
    integer :: i

    s = 12345
    do i = 1, 100000
      p1 = modulo(1403580*s(2) - 810728*s(1), m1)
      p2 = modulo(527612*s(6) - 1370589*s(4), m2)
      s = [s(2), s(3), p1, s(5), s(6), p2]
      difference = p1 - p2
      if (difference <= 0) difference = difference + m1
      x = random%uniform()
      if (abs(x - real(difference, wp)/real(m1 + 1, wp)) > 0) exit
    end do
    call t%equal(i, 100001, 'the generator in integers')
    do i = 1, 3
      first(i) = again%uniform()
    end do
    call t%check(all(nint(1000*first) == [127, 319, 309]), 'first numbers of the generator')
  end subroutine test_recurrences

  !> All 24 orders of four entries come up, equally often.
  subroutine test_shuffle()
    integer, parameter :: n = 24000
    type(random_t) :: random
    integer(i4) :: list(4)
    integer :: i, times(0:255)

    call random%seed(3)
    times = 0
    do i = 1, n
      list = [0_i4, 1_i4, 2_i4, 3_i4]
      call random%shuffle(list)
      associate (code => list(1) + 4*list(2) + 16*list(3) + 64*list(4))
        times(code) = times(code) + 1
      end associate
      if (sum(2**list) /= 15) exit
    end do
    call t%check(i == n + 1, 'shuffle: each entry once')
    call t%equal(count(times > 0), 24, 'shuffle: all orders')
    ! Each comes n/24 = 1000 times with a standard deviation of 31; five of them allowed.
    call t%check(all(times == 0 .or. abs(times - 1000) <= 155), 'shuffle: equally often')
  end subroutine test_shuffle

  subroutine test_lists()
    real(wp), allocatable :: records(:, :)
    integer :: i

    do i = 1, 1000
      call reserve(records, 2, i)
      records(:, i) = real([i, -i], wp)
    end do
    call t%check(all([(nint(records(1, i)) == i, i=1, 1000)]), 'what was there stays')
    call t%check(size(records, 2) < 2000, 'room grows by half')
  end subroutine test_lists

  !> Places in ascending lists against a look at each number, lists of all small lengths with numbers that come twice.
  subroutine test_ascending()
    integer(i8), allocatable :: list(:)
    integer :: n, value, i, expected, wrong

    wrong = 0
    do n = 0, 9
      list = int([(2*(i/2), i=1, n)], i8)
      do value = -1, n + 1
        expected = count(list < int(value, i8)) + 1
        if (first_at_least(list, int(value, i8)) /= expected) wrong = wrong + 1
        if (first_at_least(int(list, i4), int(value, i4)) /= expected) wrong = wrong + 1
        if (.not. any(list == int(value, i8))) expected = 0
        if (place_in(list, int(value, i8)) /= expected) wrong = wrong + 1
        if (place_in(int(list, i4), int(value, i4)) /= expected) wrong = wrong + 1
      end do
    end do
    call t%equal(wrong, 0, 'ascending lists: places found')
    call t%check(all(distinct([7_i4, 3_i4, 7_i4, 0_i4, 3_i4]) == [0_i4, 3_i4, 7_i4]), 'ascending lists: each number once')
    call t%equal(size(distinct([5_i8, 5_i8])), 1, 'ascending lists: one number twice')
    call t%equal(size(distinct([integer(i8) ::])), 0, 'ascending lists: no number')
  end subroutine test_ascending

  !> Keys of one digit of the radix sort and of several, some of which come twice, few and many: in order, equal ones as they were.
  subroutine test_sorting()
    integer, parameter :: sizes(8) = [0, 1, 2, 3, 64, 65, 1000, 5000]
    integer(i8), allocatable :: keys(:)
    integer(i4), allocatable :: order(:)
    type(random_t) :: random
    integer :: n, i, largest, wrong

    call random%seed(5)
    wrong = 0
    do n = 1, size(sizes)
      do largest = 1, 60, 13
        keys = [(int(random%uniform()*2.0_wp**largest, i8), i=1, sizes(n))]
        order = sort_permutation(keys)
        if (any([(count(order == i), i=1, sizes(n))] /= 1)) wrong = wrong + 1
        do i = 2, sizes(n)
          if (keys(order(i - 1)) > keys(order(i))) wrong = wrong + 1
          if (keys(order(i - 1)) == keys(order(i)) .and. order(i - 1) > order(i)) wrong = wrong + 1
        end do
      end do
    end do
    call t%equal(wrong, 0, 'keys are sorted, and equal ones keep their order')
  end subroutine test_sorting

  !> Hilbert's curve goes from each cell of a square or a cube to one next to it.
  subroutine test_curve()
    integer, parameter :: n = 16
    real(wp), allocatable :: cell(:, :)
    integer(i4), allocatable :: order(:)
    integer :: dimension, i, k

    do dimension = 2, 3
      if (allocated(cell)) deallocate (cell)
      allocate (cell(dimension, n**dimension))
      do i = 1, n**dimension
        cell(:, i) = [(real(mod((i - 1)/n**k, n), wp) + 0.5_wp, k=0, dimension - 1)]
      end do
      order = hilbert_order(cell, spread(0.0_wp, 1, dimension), real(n, wp))
      associate (way => sum(abs(cell(:, order(2:)) - cell(:, order(:size(order) - 1))), dim=1))
        call t%equal(count(nint(way) /= 1), 0, 'the curve goes from cell to cell')
      end associate
    end do
  end subroutine test_curve

  !> Each line: a pattern, names that match it, and names that do not.
  subroutine test_wildcards()
    call t%check(has_wildcard('a*') .and. has_wildcard('?') .and. .not. has_wildcard('a.b'), 'what a wildcard is')
    call t%check(all([matches('box.left', 'box.*'), matches('box.', 'box.*'), .not. matches('box', 'box.*')]), 'box.*')
    call t%check(all([matches('', '*'), matches('a', '*'), matches('a', '**'), .not. matches('', '?')]), '* and ?')
    call t%check(all([matches('sleeper', 'sl??per'), .not. matches('sleeper', 'sl?per'), .not. matches('sleeper', 'sleepe')]), '?')
    call t%check(all([matches('abcabd', 'a*abd'), matches('aaab', '*ab'), .not. matches('aaab', '*aa')]), 'a star that gives back')
    call t%check(all([matches('a*b', 'a?b'), matches('sleeper', 'sleeper'), .not. matches('sleepers', 'sleeper')]), 'no star')
  end subroutine test_wildcards
end program test_base
