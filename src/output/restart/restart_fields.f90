!> Fields of bodies and contacts in restart files: each field that its list marks so (sg_field_visitor) is a dataset of its name.
module sg_restart_fields
  use sg_field_visitor, only: field_t, kind_real, sync_never
  use sg_fields, only: fields_t
  use sg_hdf5, only: hdf5_file_t
  use sg_kinds, only: wp, i4, i8
  use sg_picked_rows, only: picked_rows_t
  use sg_sealed_datasets, only: put_sealed
  implicit none
  private
  public :: kept_field_t, fields_in_files, keep_fields, restore_fields, put_fields, get_fields, values_of

  !> Values of a field
  type :: kept_field_t
    !> What the field is
    type(field_t) :: field
    !> Its values, shape (components, items)
    real(wp), allocatable :: values(:, :)
  end type kept_field_t

contains

  !> Fields that files hold; or of those that one file holds, which may be without optional ones.
  function fields_in_files(things, group, file) result(list)
    class(fields_t), intent(in) :: things !! bodies or contacts; their arrays need not be allocated
    character(len=*), intent(in), optional :: group !! path of the group
    type(hdf5_file_t), intent(inout), optional :: file !! open file
    type(field_t), allocatable :: list(:), all_fields(:)
    logical, allocatable :: is_held(:)
    integer(i8) :: found(2)
    integer :: i

    all_fields = things%described()
    list = pack(all_fields, all_fields%in_files .and. all_fields%is_there .and. all_fields%components > 0)
    if (.not. present(file)) return
    is_held = .not. list%is_optional
    do i = 1, size(list)
      if (is_held(i)) cycle
      is_held(i) = file%has(group//'/'//trim(list(i)%name))
      if (is_held(i)) found = file%shape(group//'/'//trim(list(i)%name))
      if (is_held(i)) is_held(i) = found(1) == int(list(i)%components, i8)
    end do
    list = pack(list, is_held)
  end function fields_in_files

  !> Copy the fields that files hold.
  subroutine keep_fields(things, n, kept)
    class(fields_t), intent(in) :: things !! bodies or contacts
    integer, intent(in) :: n !! items to copy: the first ones
    type(kept_field_t), allocatable, intent(out) :: kept(:) !! their values
    integer :: i, k

    kept = empty_fields(fields_in_files(things))
    do i = 1, size(kept)
      call things%pack([(int(k, i4), k=1, n)], kept(i)%values, sync_never, kept(i)%field%place)
    end do
  end subroutine keep_fields

  !> Put values back.
  subroutine restore_fields(kept, things)
    type(kept_field_t), intent(in) :: kept(:) !! values of the first items
    class(fields_t), intent(inout) :: things !! bodies or contacts, with room for them
    integer :: i, k

    do i = 1, size(kept)
      call things%unpack([(int(k, i4), k=1, size(kept(i)%values, 2))], kept(i)%values, sync_never, kept(i)%field%place)
    end do
  end subroutine restore_fields

  !> Write fields as sealed datasets: reals as they are, all others as 32-bit integers.
  subroutine put_fields(file, group, kept)
    type(hdf5_file_t), intent(inout) :: file !! open file, perhaps shared
    character(len=*), intent(in) :: group !! path of the group, which is made
    type(kept_field_t), intent(in) :: kept(:) !! fields to write
    character(len=:), allocatable :: path
    integer :: i

    call file%group(group)
    do i = 1, size(kept)
      path = group//'/'//trim(kept(i)%field%name)
      associate (field => kept(i)%field, values => kept(i)%values)
        if (field%kind == kind_real .and. field%is_list) then
          call put_sealed(file, path, values(1, :))
        else if (field%kind == kind_real) then
          call put_sealed(file, path, values)
        else if (field%is_list) then
          call put_sealed(file, path, nint(values(1, :), i4))
        else
          call put_sealed(file, path, nint(values, i4))
        end if
      end associate
    end do
  end subroutine put_fields

  !> Read the fields that files hold.
  subroutine get_fields(file, group, rows, things, kept)
    type(hdf5_file_t), intent(inout) :: file !! open file, not shared
    character(len=*), intent(in) :: group !! path of the group
    type(picked_rows_t), intent(in) :: rows !! rows to read
    class(fields_t), intent(in) :: things !! bodies or contacts with the components of the scene
    type(kept_field_t), allocatable, intent(out) :: kept(:) !! values read
    integer :: i

    kept = empty_fields(fields_in_files(things, group, file))
    do i = 1, size(kept)
      call rows%get(file, group//'/'//trim(kept(i)%field%name), kept(i)%values)
    end do
  end subroutine get_fields

  !> Fields without values.
  pure function empty_fields(list) result(kept)
    type(field_t), intent(in) :: list(:)
    type(kept_field_t), allocatable :: kept(:)
    integer :: i

    allocate (kept(size(list)))
    do i = 1, size(list)
      kept(i)%field = list(i)
    end do
  end function empty_fields

  !> Values of one field; of no item where it is not there.
  pure function values_of(kept, name) result(values)
    type(kept_field_t), intent(in) :: kept(:) !! fields
    character(len=*), intent(in) :: name !! name of the field
    real(wp), allocatable :: values(:, :)
    integer :: i

    do i = 1, size(kept)
      if (kept(i)%field%name == name) values = kept(i)%values
    end do
    if (.not. allocated(values)) allocate (values(0, 0))
  end function values_of
end module sg_restart_fields
