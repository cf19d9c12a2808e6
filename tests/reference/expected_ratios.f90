!> Tests. Rows at any time; of ratios from a motion in which one drive moves alone; and units.
module expected_ratios
   use mechanism, only: request_t, request_ratio, drive_angle, drive_relangle
   use quad_jet, only: qp, degree_q
   use closed_forms_dyads, only: body_t
   use expected_links, only: links_by_drive
   use expected_rows, only: expected_row_t, row_by_hand, drive_word
   use expected_scales, only: listed_t, ratio_of
   implicit none
   private
   public :: row_at, unit_of

   !> The names of a ratio are so many columns wider than others.
   integer, parameter :: behind_names = 3

contains

   !> The row that `request` asks for at the time `t`, when its links are at `b`. A ratio is the
   !> velocity of its quantity, in the units of the deck, where its drive alone moves, at the rate 1; its derivative is
   !> the acceleration.
   function row_at(m, t, b, request) result(row)
      type(listed_t), intent(in) :: m
      real(qp), intent(in) :: t
      type(body_t), intent(in) :: b(:)
      type(request_t), intent(in) :: request
      type(expected_row_t) :: row
      real(qp) :: units(2)
      integer :: of_drive

      if (request%drive == 0) then
         row = row_by_hand(m, b, request)
         return
      end if
      row = row_by_hand(m, links_by_drive(m%name, m, t, b, request%drive), request)
      associate (d => m%drives(request%drive))
         row%by = drive_word(m, d)
         of_drive = merge(2, 1, any(d%kind == [drive_angle, drive_relangle]))
      end associate
      units = [1.0_qp, merge(degree_q, 1.0_qp, m%degrees)]
      row%value(1, 0) = row%value(1, 1)*units(of_drive)/units(row%dimension(1))
      row%value(1, 1) = row%value(1, 2)*units(of_drive)**2/units(row%dimension(1))
      row%value(1, 2) = 0.0_qp
      row%kind = request_ratio
      row%dimension(1) = ratio_of(row%dimension(1), of_drive)
      row%orders = 1
      row%slot(1, :) = behind_names + [1, 2, 3]
   end function row_at

   !> The unit of derivative number `k` of a length (1), an angle (2) or a ratio.
   function unit_of(m, dimension, k) result(unit)
      type(listed_t), intent(in) :: m
      integer, intent(in) :: dimension, k
      character(:), allocatable :: unit
      character(8) :: units(2)
      integer :: quantity

      units = [character(8) :: m%length_unit, merge('DEG', 'RAD', m%degrees)]
      quantity = merge(dimension, (dimension - 1)/2, dimension <= 2)
      unit = trim(units(quantity))
      if (dimension > 2) unit = unit//'/'//trim(units(dimension - 2*quantity))
      if (dimension <= 2 .and. k > 0) unit = unit//'/'//trim(m%time_unit)
      if (k == merge(2, 1, dimension <= 2)) unit = unit//'**2'
   end function unit_of
end module expected_ratios
