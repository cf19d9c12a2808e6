!> Level 4. The outcome of a trial as bytes, from a program of one kind of reals to a program of another: its values as
!> real128.
!>
!> A record is a head of whole numbers (binary digits, links, samples, times), the iterations, the times, what is known,
!> then the values.
module trial_records
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: dp => real64, qp => real128
   use text_output, only: output_t, add
   use trial_forms, only: outcome_t
   implicit none
   private
   public :: put_record, head_length, is_head, make_room, parts_of

   integer, parameter :: whole_bytes = 4, dp_bytes = 8, qp_bytes = 16
   integer, parameter :: numbers_in_head = 4
   !> Bytes of the head.
   integer, parameter :: head_length = whole_bytes*numbers_in_head

contains

   !> Writes one outcome.
   subroutine put_record(o, one)
      type(output_t), intent(inout) :: o
      type(outcome_t), intent(in) :: one
      integer :: i, k, link, order

      call put_whole(o, [one%digits, size(one%value, 2), size(one%known), size(one%time)])
      call add(o, transfer(one%iterations, repeat(' ', dp_bytes)))
      do i = 1, size(one%time)
         call add(o, transfer(one%time(i), repeat(' ', dp_bytes)))
      end do
      call put_whole(o, one%known)
      do i = 1, size(one%known)
         do order = 0, 2
            do link = 1, size(one%value, 2)
               do k = 1, 3
                  call add(o, transfer(one%value(k, link, order, i), repeat(' ', qp_bytes)))
               end do
            end do
         end do
      end do
   end subroutine put_record

   subroutine put_whole(o, numbers)
      type(output_t), intent(inout) :: o
      integer, intent(in) :: numbers(:)
      integer :: i

      do i = 1, size(numbers)
         call add(o, transfer(int(numbers(i), c_int), repeat(' ', whole_bytes)))
      end do
   end subroutine put_whole

   !> `head` begins the record of a trial of `links` links and `samples` motions, in a kind of `digits` binary digits.
   pure logical function is_head(head, digits, links, samples)
      character(head_length), intent(in) :: head
      integer, intent(in) :: digits, links, samples
      integer(c_int) :: numbers(numbers_in_head)

      numbers = transfer(head, numbers)
      is_head = all(numbers(:3) == [digits, links, samples])
   end function is_head

   !> Room for the outcome that `head` begins.
   pure subroutine make_room(head, one)
      character(head_length), intent(in) :: head
      type(outcome_t), intent(out) :: one
      integer(c_int) :: numbers(numbers_in_head)

      numbers = transfer(head, numbers)
      one%digits = numbers(1)
      allocate (one%time(numbers(4)), one%known(numbers(3)), one%value(3, numbers(2), 0:2, numbers(3)))
   end subroutine make_room

   !> Bytes of the four parts that follow the head.
   pure function parts_of(one) result(bytes)
      type(outcome_t), intent(in) :: one
      integer :: bytes(4)

      bytes = [dp_bytes, dp_bytes*size(one%time), whole_bytes*size(one%known), qp_bytes*size(one%value)]
   end function parts_of
end module trial_records
