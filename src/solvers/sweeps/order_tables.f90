!> Tables of orders of sweeps, for the memory report.
module sg_order_tables
  use sg_sweep_order, only: sweep_order_t
  use sg_tables, only: per_body, per_contact, tables_t
  implicit none
  private
  public :: list_order

contains

  !> List the tables of an order.
  subroutine list_order(order, tables)
    type(sweep_order_t), intent(in) :: order !! set or not
    type(tables_t), intent(inout) :: tables !! list to add to

    call tables%begin('order', per_contact)
    call tables%note('contact', order%contact)
    call tables%note('pair', order%pair)
    call tables%note('record', order%record)
    call tables%note('impulse', order%impulse)
    call tables%note('chosen', order%chosen)
    call tables%note('missed', order%missed)
    call tables%note('dealt', order%dealt%slots)
    call tables%note('is_dealt', order%dealt%is_dealt)
    call tables%note('group_size', order%lanes%group_size)
    call tables%note('lane_pair', order%lanes%pair)
    call tables%note('lane_record', order%lanes%record)
    call tables%note('lane_impulse', order%lanes%impulse)
    call tables%note('solid_last_row', order%solids%last_row)
    call tables%note('solid_row_size', order%solids%row_size)
    call tables%note('solid_pair', order%solids%pair)
    call tables%note('solid_row', order%solids%row)
    call tables%note('solid_special', order%solids%special)
    call tables%note('block_last', order%blocks%last)
    call tables%begin('order', per_body)
    call tables%note('groups_of', order%groups_of)
    call tables%note('moves', order%dealt%moves)
  end subroutine list_order
end module sg_order_tables
