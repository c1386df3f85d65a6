!> Are two things the same, bit by bit? Lists, and the bodies and contactors of scenes.
module same_bits
  use sg_bodies, only: bodies_t
  use sg_contactors, only: contactors_t
  use sg_field_visitor, only: field_t, sync_on_owner
  use sg_kinds, only: wp, i1, i4
  implicit none
  private
  public :: same, same_bodies, same_contactors, same_planar, same_spatial

  !> Are two lists the same, in size and bit by bit?
  interface same
    procedure :: same_list, same_table, same_numbers, same_records
  end interface same

contains

  !> Fields that are sent with a body, and presence of the others; numbers in the whole scene and owners do not count.
  logical function same_bodies(a, b)
    type(bodies_t), intent(in) :: a, b
    type(field_t), allocatable :: of_a(:), of_b(:)
    real(wp), allocatable :: one(:, :), other(:, :)
    integer :: i

    of_a = a%described()
    of_b = b%described()
    same_bodies = a%n == b%n .and. all(of_a%components == of_b%components) .and. &
                  all(of_a%bytes == of_b%bytes .or. of_a%name == 'id' .or. of_a%name == 'owner')
    if (.not. same_bodies) return
    call a%pack([(int(i, i4), i=1, a%n)], one, sync_on_owner)
    call b%pack([(int(i, i4), i=1, b%n)], other, sync_on_owner)
    same_bodies = same(one, other)
  end function same_bodies

  !> What all kinds of contactors share; tables of shapes do not count.
  pure logical function same_contactors(a, b)
    type(contactors_t), intent(in) :: a, b

    same_contactors = a%n == b%n .and. all(a%n_rows == b%n_rows)
    if (.not. same_contactors) return
    associate (n => b%n)
      same_contactors = same(a%kind, b%kind(:n)) .and. same(a%body, b%body(:n)) .and. same(a%row, b%row(:n)) .and. &
                        same(a%colour, b%colour(:n)) .and. same(a%shift, b%shift(:, :n)) .and. same(a%reach, b%reach(:n))
    end associate
  end function same_contactors

  !> Tables of the shapes in the plane; those of space are not there.
  pure logical function same_planar(a, b)
    type(contactors_t), intent(in) :: a, b
    integer :: last

    associate (n => b%n_rows)
      last = b%polygon_first(n(4) + 1) - 1
      same_planar = all(n(:4) > 0) .and. same(a%disk_radius, b%disk_radius(:n(1))) .and. &
                    same(a%segment_size, b%segment_size(:, :n(2))) .and. same(a%hollow_radius, b%hollow_radius(:n(3))) .and. &
                    same(a%polygon_first, b%polygon_first(:n(4) + 1)) .and. same(a%polygon_vertex, b%polygon_vertex(:, :last)) &
                    .and. .not. allocated(a%space%sphere_radius) .and. .not. allocated(a%space%polyhedra)
    end associate
  end function same_planar

  !> Tables of the shapes in space; those of the plane are not there.
  pure logical function same_spatial(a, b)
    type(contactors_t), intent(in) :: a, b
    integer :: i

    associate (n => b%n_rows, s => a%space, z => b%space)
      same_spatial = all(n(5:9) > 0) .and. same(s%sphere_radius, z%sphere_radius(:n(5))) .and. &
                     same(s%plane_half, z%plane_half(:, :n(6))) .and. same(s%plane_rim, z%plane_rim(:n(6))) .and. &
                     same(s%plane_frame, z%plane_frame(:, :n(6))) .and. &
                     same(s%cylinder_size, z%cylinder_size(:, :n(7))) .and. same(s%cylinder_axis, z%cylinder_axis(:, :n(7))) .and. &
                     same(s%hollow_size, z%hollow_size(:, :n(8))) .and. same(s%hollow_axis, z%hollow_axis(:, :n(8))) .and. &
                     .not. allocated(a%disk_radius) .and. .not. allocated(a%polygon_vertex)
      do i = 1, n(9)
        associate (p => s%polyhedra(i), q => z%polyhedra(i))
          same_spatial = same_spatial .and. p%n_vertices == q%n_vertices .and. p%n_faces == q%n_faces .and. &
                         p%n_edges == q%n_edges .and. same(p%vertex, q%vertex) .and. same(p%face_first, q%face_first) .and. &
                         same(p%face_vertex, q%face_vertex) .and. same(p%normal, q%normal) .and. same(p%edge, q%edge) .and. &
                         same([p%reach], [q%reach])
        end associate
      end do
    end associate
  end function same_spatial

  pure logical function same_list(a, b)
    real(wp), intent(in) :: a(:), b(:)

    same_list = size(a) == size(b)
    if (same_list) same_list = all(transfer(a, [0_i1]) == transfer(b, [0_i1]))
  end function same_list

  pure logical function same_table(a, b)
    real(wp), intent(in) :: a(:, :), b(:, :)

    same_table = all(shape(a) == shape(b))
    if (same_table) same_table = all(transfer(a, [0_i1]) == transfer(b, [0_i1]))
  end function same_table

  pure logical function same_numbers(a, b)
    integer(i4), intent(in) :: a(:), b(:)

    same_numbers = size(a) == size(b)
    if (same_numbers) same_numbers = all(a == b)
  end function same_numbers

  pure logical function same_records(a, b)
    integer(i4), intent(in) :: a(:, :), b(:, :)

    same_records = all(shape(a) == shape(b))
    if (same_records) same_records = all(a == b)
  end function same_records
end module same_bits
