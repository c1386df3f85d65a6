!> Coarse-grained fields from the blocks `[[field]]`, regions from `[[region]]`.
module sg_fields_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t
  use sg_field_options, only: field_options_t, kernel_names, most_fields
  use sg_kinds, only: wp
  use sg_region_options, only: region_options_t
  use sg_run_options, only: run_options_t
  use sg_text, only: to_text
  use sg_values, only: value_t
  use sg_words, only: choice_index, choices_of, quoted_string
  implicit none
  private
  public :: fields_from_deck, regions_from_deck

  !> Cells of a field at most: values of all cells are held by each rank
  integer, parameter :: most_cells = 10**7

contains

  !> List the fields that the deck asks for.
  subroutine fields_from_deck(deck, dimension, options, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: dimension !! of space
    type(run_options_t), intent(inout) :: options !! gets the fields
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes found
    type(field_options_t) :: field
    integer :: b

    if (deck%count_of('field') == 0) return
    allocate (options%fields(0))
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'field')) cycle
      call read_field(deck, b, dimension, field, diagnostics)
      options%fields = [options%fields, field]
    end do
    b = deck%block_of('field')
    if (size(options%fields) > most_fields) &
      call deck%complain(diagnostics, 'a deck has at most '//to_text(most_fields)//' blocks [[field]]', b)
  end subroutine fields_from_deck

  !> List the regions that the deck asks for; one without a name has its number.
  subroutine regions_from_deck(deck, dimension, options, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    integer, intent(in) :: dimension !! of space
    type(run_options_t), intent(inout) :: options !! gets the regions
    type(diagnostics_t), intent(inout) :: diagnostics !! mistakes and warnings found
    type(region_options_t), allocatable :: regions(:)
    integer :: b, n, i

    if (deck%count_of('region') == 0) return
    allocate (regions(deck%count_of('region')))
    n = 0
    do b = 1, deck%n
      if (.not. deck%is_in(b, 'region')) cycle
      n = n + 1
      regions(n)%name = to_text(n)
      if (deck%is_given(b, 'name')) regions(n)%name = deck%word(b, 'name')
      call read_box(deck, b, dimension, regions(n)%lower, regions(n)%upper, diagnostics)
      do i = 1, n - 1
        if (regions(i)%name == regions(n)%name) &
          call deck%complain(diagnostics, 'two regions have the name '//quoted_string(regions(n)%name), b, 'name')
      end do
    end do
    if (options%record_every == 0) &
      call deck%warn(diagnostics, '[[region]] has no effect with output.record_every = 0', deck%block_of('region'), &
                     kind='region without record')
    call move_alloc(regions, options%regions)
  end subroutine regions_from_deck

  !> Read the corners of a box.
  subroutine read_box(deck, b, d, lower, upper, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, d
    real(wp), intent(inout) :: lower(3), upper(3)
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: value

    value = deck%value(b, 'box')
    if (value%n /= 2*d) return
    lower(:d) = value%numbers(:d)
    upper(:d) = value%numbers(d + 1:2*d)
    if (any(lower >= upper)) &
      call deck%complain(diagnostics, 'a box is given by its least, then its largest coordinates', b, 'box')
  end subroutine read_box

  !> Read one block.
  subroutine read_field(deck, b, dimension, field, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: b, dimension
    type(field_options_t), intent(out) :: field
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: value

    associate (d => dimension)
      call read_box(deck, b, d, field%lower, field%upper, diagnostics)
      value = deck%value(b, 'cells')
      if (value%n /= d) then
        call deck%complain(diagnostics, '"cells" are '//to_text(d)//' numbers, one per axis', b, 'cells')
        return
      end if
      field%cells(:d) = nint(value%numbers(:d))
      if (product(real(field%cells, wp)) > real(most_cells, wp)) &
        call deck%complain(diagnostics, 'a field has at most '//to_text(most_cells)//' cells', b, 'cells')
      field%kernel = choice_index(deck%word(b, 'kernel'), choices_of(kernel_names))
      field%width = deck%number(b, 'width')
      if (.not. field%width > 0) field%width = maxval((field%upper(:d) - field%lower(:d))/real(field%cells(:d), wp))
    end associate
    field%every = deck%integer(b, 'every')
    field%sample_every = deck%integer(b, 'sample_every')
  end subroutine read_field
end module sg_fields_from_deck
