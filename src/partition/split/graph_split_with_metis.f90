!> Splitting by METIS 5.1, multilevel k-way [KarypisKumar1998].
submodule(sg_graph_split) graph_split_with_metis
  use, intrinsic :: iso_c_binding, only: c_f_procpointer, c_funptr, c_int, c_int32_t, c_null_ptr, c_ptr
  use sg_error, only: exit_failure, fail
  use sg_library, only: find_procedures
  use sg_library_files, only: metis_file
  use sg_text, only: to_text
  implicit none

  !> Size of METIS's list of options, places in it (from 0), and its word for success
  integer, parameter :: n_options = 40, option_seed = 8, option_ufactor = 16, option_numbering = 17, metis_ok = 1

  abstract interface
    function metis_set_default_options(options) bind(c) result(status)
      import :: c_int, c_int32_t
      integer(c_int32_t), intent(out) :: options(*)
      integer(c_int) :: status
    end function metis_set_default_options
    !> Deal vertices to parts; `volume`, `shares` and `bounds` may be null.
    function metis_part_graph_kway(n, constraints, first, neighbour, weight, volume, edge_weight, parts, shares, bounds, &
                                   options, cut, part) bind(c) result(status)
      import :: c_int, c_int32_t, c_ptr
      integer(c_int32_t), intent(in) :: n, constraints, first(*), neighbour(*), weight(*), edge_weight(*), parts, options(*)
      type(c_ptr), value :: volume, shares, bounds
      integer(c_int32_t), intent(out) :: cut
      integer(c_int32_t), intent(inout) :: part(*)
      integer(c_int) :: status
    end function metis_part_graph_kway
  end interface

contains

  module procedure graph_splits
  is_available = .true.
  end procedure graph_splits

  module procedure split_graph
  procedure(metis_set_default_options), pointer :: set_default_options
  procedure(metis_part_graph_kway), pointer :: part_graph_kway
  type(c_funptr) :: address(2)
  integer(c_int32_t) :: options(0:n_options - 1), cut
  integer(c_int) :: status
  integer :: v

  part = [(int(v, i4), v=1, graph%n)]
  ! METIS divides by zero where there is nothing to split, and leaves parts empty where there is little.
  if (graph%n <= parts) return
  part = 1
  if (parts == 1) return
  call find_procedures('METIS, which the method graph needs,', metis_file, &
                       [character(len=23) :: 'METIS_SetDefaultOptions', 'METIS_PartGraphKway'], address, error)
  if (allocated(error)) return
  call c_f_procpointer(address(1), set_default_options)
  call c_f_procpointer(address(2), part_graph_kway)
  status = set_default_options(options)
  ! Fortran counts from 1; the same deck has the same split; ufactor is the imbalance in thousandths above 1.
  options(option_numbering) = 1
  options(option_seed) = 1
  options(option_ufactor) = max(1_c_int32_t, nint(1000*(imbalance - 1), c_int32_t))
  status = part_graph_kway(int(graph%n, c_int32_t), 1_c_int32_t, graph%first, graph%neighbour, graph%weight, c_null_ptr, &
                           graph%edge_weight, int(parts, c_int32_t), c_null_ptr, c_null_ptr, options, cut, part)
  if (status /= metis_ok) call fail(error, 'METIS could not split the graph of contacts, status '//to_text(int(status)), &
                                    code=exit_failure)
  end procedure split_graph
end submodule graph_split_with_metis
