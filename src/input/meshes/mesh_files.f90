!> Meshes from files: STL, of bytes or of text, and OBJ.
module sg_mesh_files
  use sg_error, only: error_t, fail
  use sg_mesh_files_obj, only: read_obj
  use sg_mesh_files_stl, only: read_stl
  use sg_mesh_files_text, only: mesh_t, mesh_text_t, open_mesh_text, weld_mesh
  use sg_text, only: lower
  implicit none
  private
  public :: mesh_t, read_mesh

contains

  !> Read a mesh; vertices with the same coordinates are one. What it bounds, and whether it does, is not looked at.
  subroutine read_mesh(path, mesh, error)
    character(len=*), intent(in) :: path !! file, whose name ends in .stl or .obj
    type(mesh_t), intent(out) :: mesh !! vertices and faces
    type(error_t), allocatable, intent(out) :: error !! set when there is no mesh in this file
    type(mesh_text_t) :: text
    character(len=:), allocatable :: ending

    ending = lower(path(max(1, len(path) - 3):))
    if (ending /= '.stl' .and. ending /= '.obj') then
      call fail(error, 'the name of a mesh file ends in .stl or .obj', file=path)
      return
    end if
    call open_mesh_text(path, text, error)
    if (allocated(error)) return
    if (ending == '.stl') then
      call read_stl(text, mesh, error)
    else
      call read_obj(text, mesh, error)
    end if
    if (.not. allocated(error)) call weld_mesh(mesh)
  end subroutine read_mesh
end module sg_mesh_files
