!> A part of a set as a set of its own, in its own numbers.
module part_mechanism
   use mechanism, only: mechanism_t, drive_angle, drive_x, drive_y, drive_relangle, request_link, request_point
   implicit none
   private
   public :: part_t, mechanism_of

   !> Numbers of links, points, pairs, drives, requests and BRANCH cards as the whole set counts them, in the order of
   !> the part's own. A BRANCH card without a link is for each part.
   type :: part_t
      integer, allocatable :: links(:), points(:), pairs(:), drives(:), requests(:), branch_requests(:)
   end type part_t

contains

   !> The `part` of `m` as a set of its own, without its cards.
   function mechanism_of(m, part) result(own)
      type(mechanism_t), intent(in) :: m
      type(part_t), intent(in) :: part
      type(mechanism_t) :: own
      integer :: i

      own%set_number = m%set_number
      own%length_unit = m%length_unit
      own%time_unit = m%time_unit
      own%degrees = m%degrees
      own%polish = m%polish
      own%method = m%method
      own%tolerance = m%tolerance
      own%predictor = m%predictor
      own%keeps_references = m%keeps_references
      own%steps = m%steps
      own%t0 = m%t0
      own%t1 = m%t1
      own%at = m%at
      own%links = m%links(part%links)
      own%points = m%points(part%points)
      own%pairs = m%pairs(part%pairs)
      own%drives = m%drives(part%drives)
      own%requests = m%requests(part%requests)
      allocate (own%branch_requests(size(part%branch_requests)))
      do i = 1, size(part%branch_requests)
         own%branch_requests(i) = m%branch_requests(part%branch_requests(i))
         if (own%branch_requests(i)%link > 0) own%branch_requests(i)%link = place_in(part%links, &
            own%branch_requests(i)%link)
      end do
      own%points%link = [(place_in(part%links, own%points(i)%link), i=1, size(own%points))]
      own%pairs%point_i = [(place_in(part%points, own%pairs(i)%point_i), i=1, size(own%pairs))]
      own%pairs%point_j = [(place_in(part%points, own%pairs(i)%point_j), i=1, size(own%pairs))]
      call renumber_drives(part, own)
      call renumber_requests(part, own)
   end function mechanism_of

   subroutine renumber_drives(part, own)
      type(part_t), intent(in) :: part
      type(mechanism_t), intent(inout) :: own
      integer :: i

      do i = 1, size(own%drives)
         associate (d => own%drives(i))
            select case (d%kind)
            case (drive_angle)
               d%subject = place_in(part%links, d%subject)
            case (drive_relangle)
               d%subject = place_in(part%links, d%subject)
               d%second = place_in(part%links, d%second)
            case (drive_x, drive_y)
               d%subject = place_in(part%points, d%subject)
            case default
               d%subject = place_in(part%pairs, d%subject)
            end select
         end associate
      end do
   end subroutine renumber_drives

   subroutine renumber_requests(part, own)
      type(part_t), intent(in) :: part
      type(mechanism_t), intent(inout) :: own
      integer :: i

      do i = 1, size(own%requests)
         associate (r => own%requests(i))
            select case (r%kind)
            case (request_link)
               r%subject = place_in(part%links, r%subject)
            case (request_point)
               r%subject = place_in(part%points, r%subject)
            case default
               r%subject = place_in(part%pairs, r%subject)
            end select
         end associate
      end do
   end subroutine renumber_requests

   !> Where `x` stands in the increasing `list`.
   pure integer function place_in(list, x) result(middle)
      integer, intent(in) :: list(:), x
      integer :: low, high

      low = 1
      high = size(list)
      do while (low < high)
         middle = (low + high)/2
         if (list(middle) < x) then
            low = middle + 1
         else
            high = middle
         end if
      end do
      middle = low
   end function place_in
end module part_mechanism
