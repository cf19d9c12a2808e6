!> Tests. The rows of the tables from the places of the links, as jets in real128: a link's own, those of its points,
!> and of pairs the angle or the slide.
module hand_rows
   use mechanism, only: mechanism_t, request_t, request_link, request_point, pair_prismatic
   use quad_jet, only: qp, jet_t, operator(+), operator(-), operator(*), sin, cos
   use closed_forms_dyads, only: body_t, place_t, place_on
   implicit none
   private
   public :: hand_row_t, row_by_hand

   !> A row of the kind `kind` of a request; `column`: which of x, y, phi its values stand under, a slide under x and the
   !> angle of a pair under phi; `links`: those that it depends on.
   type :: hand_row_t
      integer :: kind = request_link
      character(8) :: name = ''
      integer :: columns = 3, column(3) = [1, 2, 3]
      integer :: links(2) = 0
      real(qp) :: value(3, 0:2) = 0.0_qp
   end type hand_row_t

contains

   !> The row that `request` asks for, of the links `b` in the order of the deck.
   function row_by_hand(m, b, request) result(row)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      type(request_t), intent(in) :: request
      type(hand_row_t) :: row
      type(place_t) :: p

      row%kind = request%kind
      associate (i => request%subject)
         select case (request%kind)
         case (request_link)
            row%name = m%links(i)%name
            row%links = i
            call take([b(i)%x, b(i)%y, b(i)%phi], row)
         case (request_point)
            row%name = m%points(i)%name
            row%links = m%points(i)%link
            p = point(m, b, i)
            call take([p%x, p%y], row)
         case default
            row%name = m%pairs(i)%name
            row%links = m%points([m%pairs(i)%point_i, m%pairs(i)%point_j])%link
            if (m%pairs(i)%kind /= pair_prismatic) row%column(1) = 3
            call take([pair_value(m, b, i)], row)
         end select
      end associate
   end function row_by_hand

   subroutine take(value, row)
      type(jet_t), intent(in) :: value(:)
      type(hand_row_t), intent(inout) :: row

      row%columns = size(value)
      row%value(:size(value), 0) = value%v
      row%value(:size(value), 1) = value%d
      row%value(:size(value), 2) = value%dd
   end subroutine take

   !> Point number `i` of the plane.
   type(place_t) function point(m, b, i)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      integer, intent(in) :: i

      point = place_on(b(m%points(i)%link), real(m%points(i)%offset(1), qp), real(m%points(i)%offset(2), qp))
   end function point

   !> The angle of pair number `i`, or how far its second point is along its guide.
   type(jet_t) function pair_value(m, b, i) result(value)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      integer, intent(in) :: i
      type(place_t) :: p, q
      type(jet_t) :: guide

      associate (pair => m%pairs(i))
         associate (first => b(m%points(pair%point_i)%link), second => b(m%points(pair%point_j)%link))
            value = second%phi - first%phi
            if (pair%kind /= pair_prismatic) return
            p = point(m, b, pair%point_i)
            q = point(m, b, pair%point_j)
            guide = first%phi + real(pair%alpha, qp)
            value = (q%x - p%x)*cos(guide) + (q%y - p%y)*sin(guide)
         end associate
      end associate
   end function pair_value
end module hand_rows
